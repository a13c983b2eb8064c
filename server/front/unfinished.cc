#include "server/front/unfinished.h"

namespace uplink::front {

void Unfinished::Set(std::uint64_t call, std::uint64_t message, std::size_t bytes, SteadyTime now) {
  const auto found = entries_.find(call);
  if (found == entries_.end()) {
    if (bytes == 0) return;
    entries_.emplace(call, Entry{now, message, bytes});
    by_age_.emplace(now, call);
    bytes_ += bytes;
    return;
  }
  Entry& entry = found->second;
  bytes_ = bytes_ - entry.bytes + bytes;
  entry.bytes = bytes;
  if (bytes > 0 && entry.message == message) return;
  auto node = by_age_.extract({entry.began, call});
  if (bytes == 0) {
    entries_.erase(found);
    return;
  }
  entry.message = message;
  entry.began = now;
  node.value().first = now;
  by_age_.insert(std::move(node));
}

std::optional<std::uint64_t> Unfinished::TooSlow() const {
  if (bytes_ <= bytes_max_ || by_age_.empty()) return std::nullopt;
  return by_age_.begin()->second;
}

}  // namespace uplink::front
