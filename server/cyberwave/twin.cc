#include "server/cyberwave/twin.h"

namespace uplink::cyberwave {

Applied Twin::Apply(Judgement&& judgement, const Arrival& arrival) {
  const std::lock_guard lock(mutex_);
  Applied applied = state_.Apply(std::move(judgement), arrival);
  bytes_ = HeldBytes(state_.parts());
  return applied;
}

void Twin::RestoreFaults(const std::vector<std::string>& fault_ids) {
  const std::lock_guard lock(mutex_);
  state_.RestoreFaults(fault_ids);
}

void Twin::DropTables() {
  const std::lock_guard lock(mutex_);
  state_.DropTables();
  bytes_ = HeldBytes(state_.parts());
}

std::size_t Twin::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace uplink::cyberwave
