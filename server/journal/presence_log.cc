#include "server/journal/presence_log.h"

#include <algorithm>
#include <utility>

namespace uplink::journal {

void PresenceLog::Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at) {
  const auto handed = handed_.find(robot->ruri);
  if (handed != handed_.end() && handed->second == presence) {
    waiting_.erase(robot->ruri);
    return;
  }
  waiting_.insert_or_assign(robot->ruri, storage::PresenceItem{robot, presence, at, 0});
}

std::vector<storage::PresenceItem> PresenceLog::Take(std::size_t items_max) {
  std::vector<storage::PresenceItem> items;
  items.reserve(std::min(items_max, waiting_.size()));
  while (!waiting_.empty() && items.size() < items_max) {
    auto first = waiting_.extract(waiting_.begin());
    first.mapped().number = ++last_number_;
    handed_[first.key()] = first.mapped().presence;
    items.push_back(std::move(first.mapped()));
  }
  return items;
}

}  // namespace uplink::journal
