#include "server/cyberwave/twin.h"

namespace uplink::cyberwave {

std::size_t Twin::RecordsAtMost(const Judgement& judgement) const {
  const std::lock_guard lock(mutex_);
  return state_.RecordsAtMost(judgement);
}

Applied Twin::Apply(Judgement&& judgement, const Arrival& arrival, HeldChange& change) {
  const std::lock_guard lock(mutex_);
  Applied applied = state_.Apply(std::move(judgement), arrival);
  change.before = bytes_;
  change.after = bytes_ = state_.held_bytes();
  return applied;
}

void Twin::RestoreFaults(const std::vector<std::string>& fault_ids) {
  const std::lock_guard lock(mutex_);
  state_.RestoreFaults(fault_ids);
}

void Twin::DropTables() {
  const std::lock_guard lock(mutex_);
  state_.DropTables();
  bytes_ = state_.held_bytes();
}

std::vector<std::string> Twin::ActiveFaults() const {
  const std::lock_guard lock(mutex_);
  return {state_.faults().active().begin(), state_.faults().active().end()};
}

std::size_t Twin::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace uplink::cyberwave
