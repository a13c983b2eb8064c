#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "server/limits/token_bucket.h"

namespace uplink::robot {

/// Counts the messages of one robot that a Reject answers, and says when there were too many
/// (kRejectsPerSecondMax): a robot that connects again has no more of them. What is over is then
/// spread over the seconds, kRejectsAtOnce at a time, so that no burst of it keeps others
/// waiting.
///
/// Thread: confined to the robot's stream, of which there is one at a time: the next one begins
///         behind the RobotSessions::Detach of the one before.
class Throttle final {
 public:
  void Add(SteadyTime now);
  /// When messages may be processed again after too many, also if that has come; nothing without
  /// too many.
  [[nodiscard]] std::optional<SteadyTime> end() const { return end_; }

 private:
  limits::TokenBucket bucket_;
  std::optional<SteadyTime> end_;
};

}  // namespace uplink::robot
