#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "server/log/logger.h"
#include "server/log/rate_limited.h"

namespace uplink::forward {

/// Robots to which something applies: the log names each once while it does, up to
/// kForwardLinesMax a minute. Confined to its owner's thread.
class ToldRobots final {
 public:
  /// `event` is what the log says of them. The logger outlives it.
  ToldRobots(const log::Logger& logger, std::string event);

  /// These are the robots now.
  void Tell(std::set<std::string> robots);
  [[nodiscard]] bool empty() const { return robots_.empty(); }

 private:
  const std::string event_;
  log::RateLimited lines_;
  std::set<std::string> robots_;
};

}  // namespace uplink::forward
