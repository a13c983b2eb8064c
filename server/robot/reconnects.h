#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "server/limits/recent_times.h"
#include "server/robot/limits.h"

namespace uplink::robot {

/// Limits of how often streams of one robot may come. A value.
struct ReconnectLimits {
  /// Streams per minute that do not wait; with kStreamTimesMax none ever waits.
  std::uint32_t per_minute = kStreamsPerMinuteMax;
  /// Longest wait of one stream.
  milliseconds delay_max = kStreamDelayMax;
};

/// When streams of one robot came, and how long a new one must wait if they come too often: past
/// the limit per minute, each waits twice as long as the one before. Confined to its owner's lock.
///
/// Bounds: kStreamTimesMax times; kStreamsWaitingMax streams wait at once.
class Reconnects final {
 public:
  struct Arrival {
    /// Grows with each stream that came.
    std::uint64_t number = 0;
    /// Zero: no wait. Otherwise EndWait must follow.
    milliseconds delay{0};
  };
  /// A stream came. Empty if it would have to wait and kStreamsWaitingMax already do.
  [[nodiscard]] std::optional<Arrival> Arrive(SteadyTime now, const ReconnectLimits& limits);
  /// A stream no longer waits.
  void EndWait() { --waiting_; }
  /// The stream wants the robot now. False if a later stream has had it since: no stream takes over
  /// from a newer one.
  [[nodiscard]] bool MayAttach(std::uint64_t number);

 private:
  /// When streams came. Remembering more would make no stream wait longer.
  limits::RecentTimes<kStreamTimesMax> came_;
  std::uint64_t last_number_ = 0;
  /// The number of the newest stream that wanted the robot.
  std::uint64_t attached_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace uplink::robot
