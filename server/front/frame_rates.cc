#include "server/front/frame_rates.h"

#include <algorithm>
#include <chrono>

namespace uplink::front {
namespace {

/// After so long a further frame may come.
constexpr SteadyTime::duration IntervalOf(const FrameLimit& limit) {
  return SteadyTime::duration(std::chrono::seconds(1)) / limit.rate;
}

constexpr bool TableIsSound() {
  for (std::size_t i = 0; i < kFrameLimits.size(); ++i) {
    const FrameLimit& limit = kFrameLimits[i];
    if (static_cast<std::size_t>(limit.kind) != i || limit.rate == 0 || limit.burst == 0) {
      return false;
    }
    if (IntervalOf(limit) * limit.rate != std::chrono::seconds(1)) return false;
  }
  return true;
}
static_assert(TableIsSound(), "kFrameLimits is by kind, and its intervals are whole nanoseconds");

}  // namespace

bool FrameRates::Take(FrameKind kind, SteadyTime now) {
  const FrameLimit& limit = LimitOf(kind);
  SteadyTime& full_at = full_at_[static_cast<std::size_t>(kind)];
  const SteadyTime then = std::max(full_at, now) + IntervalOf(limit);
  // Rounded up: a peer with fewer streams than a robot's has its one frame, too.
  const auto burst =
      limit.scope == FrameScope::kStreams
          ? (std::uint64_t{limit.burst} * streams_max_ + kRobotStreamsMax - 1) / kRobotStreamsMax
          : limit.burst;
  if (then - now > IntervalOf(limit) * static_cast<SteadyTime::rep>(burst)) return false;
  full_at = then;
  return true;
}

}  // namespace uplink::front
