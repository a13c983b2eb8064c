#include "server/forward/once_per_robot_log.h"

#include <chrono>
#include <utility>

#include "server/forward/limits.h"

namespace uplink::forward {

OncePerRobotLog::OncePerRobotLog(const log::Logger& logger, std::string event, std::string other)
    : event_(std::move(event)),
      other_(std::move(other)),
      lines_(logger, kForwardLinesMax, std::chrono::minutes(1)) {}

bool OncePerRobotLog::Write(const std::string& robot, const std::string& other) {
  if (other.empty()) return lines_.Write(log::Level::kWarn, event_, {{"robot", robot}});
  return lines_.Write(log::Level::kWarn, event_, {{"robot", robot}, {other_, other}});
}

void OncePerRobotLog::Tell(const Robots& robots) {
  none_ = robots.empty();
  std::erase_if(told_, [&](const std::string& robot) { return !robots.contains(robot); });
  for (const auto& [robot, other] : robots) {
    if (told_.contains(robot)) continue;
    // A suppressed line is counted by the next one, and the next look tries again.
    if (!Write(robot, other)) return;
    told_.insert(robot);
  }
}

}  // namespace uplink::forward
