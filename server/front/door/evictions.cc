#include "server/front/door/evictions.h"

#include <algorithm>

namespace uplink::front {

std::size_t Evictions::Note(const KeyDigest& digest, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (const auto found = by_digest_.find(digest); found != by_digest_.end()) {
    keys_.splice(keys_.begin(), keys_, found->second);
  } else {
    if (keys_.size() >= kKeysMax) {
      by_digest_.erase(keys_.back().digest);
      keys_.pop_back();
    }
    keys_.push_front({.digest = digest, .times = {}});
    by_digest_.emplace(digest, keys_.begin());
  }
  std::vector<SteadyTime>& times = keys_.front().times;
  if (times.size() == kEvictionsFlagged) times.erase(times.begin());
  times.push_back(now);
  return static_cast<std::size_t>(std::count_if(
      times.begin(), times.end(), [now](SteadyTime at) { return now - at < kEvictionsWithin; }));
}

}  // namespace uplink::front
