#include "server/session/throttle.h"

#include <chrono>

#include "server/session/limits.h"

namespace uplink::session {

void Throttle::AddMalformed(SteadyTime now) {
  if (now - since_ >= std::chrono::seconds(1)) {
    since_ = now;
    malformed_ = 0;
  }
  ++malformed_;
}

std::optional<SteadyTime> Throttle::end() const {
  if (malformed_ <= kMalformedPerSecondMax) return std::nullopt;
  return since_ + std::chrono::seconds(1);
}

}  // namespace uplink::session
