#pragma once

#include <optional>

#include "schema/base/clock.h"

namespace uplink::robot {

/// Until when a robot is parked: it said that it leaves, and when it is expected back. A sign of
/// life ends that, and so does its time, by the server's clock or, if that was set back, after as
/// long. Confined to its owner's lock.
class Parking final {
 public:
  /// One look at both clocks.
  struct Now {
    SteadyTime steady;
    SystemTime system;
  };

  /// The robot leaves until `until`. Signs of life before `signs_count_from` were under way and end
  /// nothing; SteadyTime::max() while its stream is open (EndStream).
  void Begin(SystemTime until, SteadyTime signs_count_from);
  /// The stream on which it said so has ended: from now on a sign of life shows that it is back.
  void EndStream(SteadyTime now);
  /// What the store has of it. It ends with its first sign of life here.
  void Follow(std::optional<SystemTime> until);
  /// A sign of life of this time. True if it ended the parking.
  bool AddSign(SteadyTime at);
  /// Ends it if its time has come: at most `max` after the first call.
  void Reach(Now now, milliseconds max);

  /// Empty: it is not parked.
  [[nodiscard]] std::optional<SystemTime> until() const;

 private:
  std::optional<SystemTime> until_;
  /// Its end if the civil clock stands still or goes back; from the first Reach on.
  std::optional<SteadyTime> deadline_;
  SteadyTime signs_count_from_;
  bool over_ = false;
};

}  // namespace uplink::robot
