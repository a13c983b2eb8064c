#include "schema/base/backoff.h"

#include <algorithm>

#include "schema/base/check.h"

namespace uplink {

Backoff::Backoff(const BackoffLimits& limits) : limits_(limits), bound_(limits.first) {
  UPLINK_CHECK(limits.first >= milliseconds(2), "a first pause under 2 ms has no half");
  UPLINK_CHECK(limits.longest >= limits.first, "the longest pause is below the first");
}

milliseconds Backoff::Next(std::uint64_t random) {
  const milliseconds half = bound_ / 2;
  const auto steps = static_cast<std::uint64_t>((bound_ - half).count()) + 1;
  const milliseconds pause = half + milliseconds(random % steps);
  // Compared by halves: doubling first could overflow.
  bound_ = bound_ > limits_.longest / 2 ? limits_.longest : bound_ * 2;
  return pause;
}

}  // namespace uplink
