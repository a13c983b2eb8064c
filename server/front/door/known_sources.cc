#include "server/front/door/known_sources.h"

#include <algorithm>

namespace uplink::front {

void KnownSources::Enter(const SourceAddress& source) {
  const std::lock_guard lock(mutex_);
  streams_.Add(source);
}

void KnownSources::Leave(const SourceAddress& source, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  streams_.Drop(source);
  SteadyTime& ended = ended_.Touch(source);
  ended = std::max(ended, now);
  ended_.ForgetWhile([now](SteadyTime each) { return now - each >= kKnownFor; });
}

bool KnownSources::IsKnown(const SourceAddress& source, SteadyTime now) const {
  const std::lock_guard lock(mutex_);
  if (streams_.Of(source) > 0) return true;
  const SteadyTime* const ended = ended_.Find(source);
  return ended != nullptr && now - *ended < kKnownFor;
}

std::size_t KnownSources::size() const {
  const std::lock_guard lock(mutex_);
  return ended_.size();
}

}  // namespace uplink::front
