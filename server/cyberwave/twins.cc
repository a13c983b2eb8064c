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
  return twins_.emplace(ruri, std::make_shared<Twin>(ruri, id)).first->second;
}

std::vector<TwinPtr> Twins::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<TwinPtr> all;
  all.reserve(twins_.size());
  for (const auto& [ruri, twin] : twins_) all.push_back(twin);
  return all;
}

void Twins::Remove(std::string_view ruri) {
  const std::lock_guard lock(mutex_);
  const auto found = twins_.find(std::string(ruri));
  if (found == twins_.end()) return;
  bytes_.fetch_sub(found->second->bytes());
  twins_.erase(found);
}

void Twins::Clear() {
  const std::lock_guard lock(mutex_);
  twins_.clear();
  bytes_.store(0);
}

Applied Twins::Apply(Twin& twin, Judgement&& judgement, const Arrival& arrival) {
  Twin::HeldChange held;
  Applied applied = twin.Apply(std::move(judgement), arrival, held);
  // One thread changes what twins hold, so that the sum is exact.
  const std::size_t others = bytes_.load() - held.before;
  if (others + held.after > bytes_max_ && held.after > kTwinBytesKept) {
    twin.DropTables();
    tables_dropped_.fetch_add(1);
    held.after = twin.bytes();
  }
  if (held.after != held.before) bytes_.store(others + held.after);
  return applied;
}

std::size_t Twins::size() const {
  const std::lock_guard lock(mutex_);
  return twins_.size();
}

}  // namespace uplink::cyberwave
