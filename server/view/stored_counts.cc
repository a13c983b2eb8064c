#include "server/view/stored_counts.h"

#include "server/view/queries.h"

namespace uplink::view {

bool StoredCounts::Read(const std::vector<std::string>& ruris) {
  const auto faults = context_.reader.ActiveFaultCounts(ruris);
  if (!faults.ok()) return false;
  absl::StatusOr<std::vector<storage::OpenRequestCount>> requests =
      std::vector<storage::OpenRequestCount>();
  if (context_.with_requests) requests = context_.reader.OpenRequestCounts(ruris);
  if (!requests.ok()) return false;
  const std::lock_guard lock(mutex_);
  // Forgets robots that left. The counts of the others are read again.
  if (counts_.size() > 2 * context_.robots_max) counts_.clear();
  for (const std::string& ruri : ruris) counts_[ruri] = {};
  for (const auto& count : *faults) counts_[count.ruri].active_faults = count.count;
  for (const auto& count : *requests) counts_[count.ruri].open_requests = count.count;
  return true;
}

void StoredCounts::Fill(std::vector<RobotView>& robots) const {
  const std::lock_guard lock(mutex_);
  for (RobotView& robot : robots) {
    const auto known = counts_.find(robot.id.ruri);
    if (known == counts_.end()) continue;
    robot.active_faults = known->second.active_faults;
    if (robot.calls_here) continue;
    robot.operator_requests_open = static_cast<std::size_t>(known->second.open_requests);
  }
}

}  // namespace uplink::view
