#include "server/front/known_sources.h"

#include <algorithm>

namespace uplink::front {

void KnownSources::Note(const SourceAddress& source, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (const auto found = by_source_.find(source); found != by_source_.end()) {
    found->second->noted = std::max(found->second->noted, now);
    entries_.splice(entries_.begin(), entries_, found->second);
  } else {
    if (entries_.size() >= kKnownSourcesMax) ForgetLast();
    entries_.push_front({.source = source, .noted = now});
    by_source_.emplace(source, entries_.begin());
  }
  while (now - entries_.back().noted >= kKnownFor) ForgetLast();
}

bool KnownSources::IsKnown(const SourceAddress& source, SteadyTime now) const {
  const std::lock_guard lock(mutex_);
  const auto found = by_source_.find(source);
  return found != by_source_.end() && now - found->second->noted < kKnownFor;
}

std::size_t KnownSources::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

void KnownSources::ForgetLast() {
  by_source_.erase(entries_.back().source);
  entries_.pop_back();
}

}  // namespace uplink::front
