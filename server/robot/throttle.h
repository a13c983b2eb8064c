#pragma once

#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::robot {

/// Counts the malformed messages of one robot, and says when there were too many in one second
/// (kMalformedPerSecondMax): a robot that connects again begins no new second.
///
/// Thread: confined to the robot's stream, of which there is one at a time: the next one begins
///         behind the RobotSessions::Detach of the one before.
class Throttle final {
 public:
  void AddMalformed(SteadyTime now);
  /// When messages may be processed again after too many malformed ones in this second, also if
  /// that has come; nothing without too many.
  [[nodiscard]] std::optional<SteadyTime> end() const;

 private:
  SteadyTime since_{};
  std::uint32_t malformed_ = 0;
};

}  // namespace uplink::robot
