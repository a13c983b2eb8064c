#include "server/mqtt/unacked.h"

#include "schema/base/check.h"

namespace uplink::mqtt {

Unacked::Delivery Unacked::Add(PacketId id, bool dup) {
  UPLINK_CHECK(!full(), "a PUBLISH was read past the window");
  const auto known = number_of_.find(id);
  if (known != number_of_.end()) {
    if (dup) return {AckHandle{connection_, known->second}, true};
    entries_[known->second - first_].replaced = true;
  } else if (dup && acked_[id]) {
    return {std::nullopt, true};
  }
  acked_.reset(id);
  const std::uint64_t number = first_ + entries_.size();
  entries_.push_back({.id = id});
  number_of_.insert_or_assign(id, number);
  return {AckHandle{connection_, number}, false};
}

bool Unacked::Holds(const AckHandle& handle) const {
  return handle.connection == connection_ && handle.number >= first_ &&
         handle.number - first_ < entries_.size() && !entries_[handle.number - first_].released;
}

std::vector<PacketId> Unacked::Release(const AckHandle& handle) {
  if (!Holds(handle)) return {};
  entries_[handle.number - first_].released = true;
  std::vector<PacketId> due;
  for (; !entries_.empty() && entries_.front().released; ++first_) {
    const Entry& entry = entries_.front();
    if (!entry.replaced) {
      due.push_back(entry.id);
      acked_.set(entry.id);
      number_of_.erase(entry.id);
    }
    entries_.pop_front();
  }
  return due;
}

}  // namespace uplink::mqtt
