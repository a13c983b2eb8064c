#include "server/front/door/evictions.h"

namespace uplink::front {

std::size_t Evictions::Note(const KeyDigest& digest, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  auto& times = keys_.Touch(digest);
  times.Note(now);
  return times.Within(now, kEvictionsWithin);
}

}  // namespace uplink::front
