#include "server/forward/told_robots.h"

#include <chrono>
#include <utility>

#include "server/forward/limits.h"

namespace uplink::forward {

ToldRobots::ToldRobots(const log::Logger& logger, std::string event)
    : event_(std::move(event)), lines_(logger, kForwardLinesMax, std::chrono::minutes(1)) {}

void ToldRobots::Tell(std::set<std::string> robots) {
  for (const std::string& robot : robots) {
    if (!robots_.contains(robot)) lines_.Write(log::Level::kWarn, event_, {{"robot", robot}});
  }
  robots_ = std::move(robots);
}

}  // namespace uplink::forward
