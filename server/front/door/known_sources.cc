#include "server/front/door/known_sources.h"

#include <algorithm>

#include "schema/base/check.h"

namespace uplink::front {

void KnownSources::Enter(const SourceAddress& source) {
  const std::lock_guard lock(mutex_);
  ++streams_[source];
}

void KnownSources::Leave(const SourceAddress& source, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  const auto found = streams_.find(source);
  UPLINK_CHECK(found != streams_.end(), "a stream that leaves has entered");
  if (--found->second == 0) streams_.erase(found);
  Note(source, now);
}

void KnownSources::Note(const SourceAddress& source, SteadyTime now) {
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
  if (streams_.contains(source)) return true;
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
