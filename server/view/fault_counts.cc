#include "server/view/fault_counts.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace uplink::view {

absl::Status FaultCounts::Refresh(const fleet::Fleet& fleet, storage::Reader& reader) {
  std::vector<std::string> ruris;
  for (const fleet::RobotPtr& robot : fleet.All()) ruris.push_back(robot->ruri());
  auto counts = std::make_shared<Map>();
  for (std::span<const std::string> left = ruris; !left.empty();) {
    const std::size_t now = std::min(left.size(), kFaultCountsRobots);
    const auto rows = reader.ActiveFaultCounts(left.first(now));
    if (!rows.ok()) return rows.status();
    for (const storage::ActiveFaults& row : *rows) counts->emplace(row.ruri, row.by_severity);
    left = left.subspan(now);
  }
  const std::lock_guard lock(mutex_);
  counts_ = std::move(counts);
  counted_at_ = clock_.Steady();
  return absl::OkStatus();
}

void FaultCounts::RefreshOn(const loop::Post& post, const fleet::Fleet& fleet,
                            storage::Reader& reader) {
  refreshes_.PostBy(post, [this, &fleet, &reader] {
    // After a failure it is read again later; the writers log errors of the store.
    static_cast<void>(Refresh(fleet, reader));
  });
}

bool FaultCounts::fresh() const {
  const SteadyTime now = clock_.Steady();
  const std::lock_guard lock(mutex_);
  return counts_ != nullptr && now - counted_at_ < kFaultCountsFresh;
}

std::shared_ptr<const FaultCounts::Map> FaultCounts::counts() const {
  const SteadyTime now = clock_.Steady();
  const std::lock_guard lock(mutex_);
  if (counts_ == nullptr || now - counted_at_ > kFaultCountsAgeMax) return nullptr;
  return counts_;
}

}  // namespace uplink::view
