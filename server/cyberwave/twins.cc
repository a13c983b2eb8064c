#include "server/cyberwave/twins.h"

#include <utility>

namespace uplink::cyberwave {

TwinPtr Twins::Find(std::string_view ruri) const {
  const std::lock_guard lock(mutex_);
  const auto found = twins_.find(std::string(ruri));
  return found == twins_.end() ? nullptr : found->second;
}

TwinPtr Twins::FindOrAdd(const std::string& ruri, const model::cyberwave::Uuid& id) {
  const std::lock_guard lock(mutex_);
  const auto found = twins_.find(ruri);
  if (found != twins_.end()) return found->second;
  if (twins_.size() >= twins_max_) return nullptr;
  auto twin = std::make_shared<Twin>(ruri, id);
  twin->CountIn(total_);
  return twins_.emplace(ruri, std::move(twin)).first->second;
}

std::vector<TwinPtr> Twins::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<TwinPtr> all;
  all.reserve(twins_.size());
  for (const auto& [ruri, twin] : twins_) all.push_back(twin);
  return all;
}

void Twins::Remove(std::string_view ruri) {
  TwinPtr removed;
  {
    const std::lock_guard lock(mutex_);
    const auto found = twins_.find(std::string(ruri));
    if (found == twins_.end()) return;
    removed = std::move(found->second);
    twins_.erase(found);
  }
  // Another thread may keep it for a moment.
  removed->CountIn(nullptr);
}

void Twins::Clear() {
  std::unordered_map<std::string, TwinPtr> removed;
  {
    const std::lock_guard lock(mutex_);
    removed.swap(twins_);
  }
  for (const auto& [ruri, twin] : removed) twin->CountIn(nullptr);
}

Applied Twins::Apply(Twin& twin, Judgement&& judgement, const Arrival& arrival) {
  Applied applied = twin.Apply(std::move(judgement), arrival);
  total_->Check();
  return applied;
}

std::size_t Twins::DropTable(Twin& twin, TwinTable table) {
  tables_dropped_.fetch_add(1);
  return twin.DropTable(table);
}

std::size_t Twins::size() const {
  const std::lock_guard lock(mutex_);
  return twins_.size();
}

}  // namespace uplink::cyberwave
