#include "server/robot/throttle.h"

#include <chrono>

#include "server/robot/limits.h"

namespace uplink::robot {

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

}  // namespace uplink::robot
