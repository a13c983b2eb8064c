#include "server/view/sorted_robots.h"

#include "server/view/robots_filter.h"
#include "storage/origin.h"

namespace uplink::view {

std::shared_ptr<const SortedRobots::List> SortedRobots::Get() {
  // Read first: a robot that comes meanwhile is a change that the next look sees.
  const std::uint64_t changes = fleet_.changes();
  {
    const std::lock_guard lock(mutex_);
    if (list_ != nullptr && changes == changes_) return list_;
  }
  auto list = std::make_shared<List>();
  for (const fleet::RobotPtr& robot : fleet_.Sorted()) {
    if (storage::IsNoRobot(robot->ruri())) continue;
    list->push_back({.robot = robot, .short_name = ShortNameOf(robot->ruri())});
  }
  const std::lock_guard lock(mutex_);
  list_ = list;
  changes_ = changes;
  return list;
}

}  // namespace uplink::view
