#include "server/front/unfinished.h"

namespace uplink::front {

void Unfinished::Set(std::uint64_t call, std::size_t bytes, SteadyTime now) {
  const auto found = entries_.find(call);
  if (found == entries_.end()) {
    if (bytes == 0) return;
    entries_.emplace(call, Entry{now, bytes});
    by_age_.emplace(now, call);
    bytes_ += bytes;
    return;
  }
  bytes_ = bytes_ - found->second.bytes + bytes;
  found->second.bytes = bytes;
  if (bytes > 0) return;
  by_age_.erase({found->second.began, call});
  entries_.erase(found);
}

std::optional<std::uint64_t> Unfinished::TooSlow() const {
  if (bytes_ <= bytes_max_ || by_age_.empty()) return std::nullopt;
  return by_age_.begin()->second;
}

}  // namespace uplink::front
