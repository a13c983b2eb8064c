#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "server/limits/token_bucket.h"

namespace uplink::robot {

/// Counts the messages of one robot that Rejects answer, and limits them (kRejectsPerSecondMax);
/// reconnecting allows no more. Messages past the limit are spread over the seconds, kRejectsAtOnce
/// at a time, so that no burst delays others.
///
/// Thread: confined to the robot's stream. The robot has one at a time: the next one begins after
///         the RobotSessions::Detach of the last.
class Throttle final {
 public:
  void Add(SteadyTime now);
  /// When messages may be processed again after too many, even if that time has passed; empty
  /// without too many.
  [[nodiscard]] std::optional<SteadyTime> end() const { return end_; }

 private:
  limits::TokenBucket bucket_;
  std::optional<SteadyTime> end_;
};

}  // namespace uplink::robot
