#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "server/log/logger.h"
#include "server/log/rate_limited.h"

namespace uplink::forward {

/// Logs robots to which something applies, each once while it does. Past kForwardLinesMax names in
/// a minute, the rest come in the next one. Confined to its owner's thread.
class OncePerRobotLog final {
 public:
  /// Each with another robot that causes it; empty: none.
  using Robots = std::map<std::string, std::string>;

  /// `event` is the event of their lines, and `other` the key of the other robot. The logger
  /// outlives it.
  OncePerRobotLog(const log::Logger& logger, std::string event, std::string other = {});

  /// These are the robots now.
  void Tell(const Robots& robots);
  /// It applied to none at the last Tell.
  [[nodiscard]] bool none() const { return none_; }

 private:
  [[nodiscard]] bool Write(const std::string& robot, const std::string& other);

  const std::string event_;
  const std::string other_;
  log::RateLimited lines_;
  /// Robots that were named.
  std::set<std::string> told_;
  bool none_ = true;
};

}  // namespace uplink::forward
