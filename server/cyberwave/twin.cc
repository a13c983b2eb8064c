#include "server/cyberwave/twin.h"

#include <utility>

namespace uplink::cyberwave {

std::size_t Twin::RecordsAtMost(const Judgement& judgement) const {
  const std::lock_guard lock(mutex_);
  return state_.RecordsAtMost(judgement);
}

void Twin::CountIn(std::shared_ptr<robot::LiveTotal> total) {
  const std::lock_guard lock(mutex_);
  share_.CountIn(std::move(total));
}

Applied Twin::Apply(Judgement&& judgement, const Arrival& arrival) {
  const std::lock_guard lock(mutex_);
  ++changes_;
  Applied applied = state_.Apply(std::move(judgement), arrival);
  share_.Set(state_.held_bytes());
  return applied;
}

void Twin::RestoreFaults(const std::vector<std::string>& fault_ids) {
  const std::lock_guard lock(mutex_);
  state_.RestoreFaults(fault_ids);
}

std::size_t Twin::DropTable(TwinTable table) {
  const std::lock_guard lock(mutex_);
  const std::size_t before = state_.held_bytes();
  ++changes_;
  state_.DropTable(table);
  share_.Set(state_.held_bytes());
  return before - share_.bytes();
}

std::vector<std::string> Twin::ActiveFaults() const {
  const std::lock_guard lock(mutex_);
  return {state_.faults().active().begin(), state_.faults().active().end()};
}

std::size_t Twin::bytes() const {
  const std::lock_guard lock(mutex_);
  return share_.bytes();
}

TwinTableBytes Twin::table_bytes() const {
  const std::lock_guard lock(mutex_);
  return TableBytes(state_.parts());
}

}  // namespace uplink::cyberwave
