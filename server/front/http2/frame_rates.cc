#include "server/front/http2/frame_rates.h"

#include <algorithm>
#include <chrono>

namespace uplink::front {
namespace {

/// After so long a further frame may come, at so many per second.
constexpr SteadyTime::duration IntervalOf(std::uint32_t rate) {
  return SteadyTime::duration(std::chrono::seconds(1)) / rate;
}

/// Rounded up, so that a peer with fewer streams than a robot still has one frame.
constexpr std::uint64_t BurstOf(const FrameLimit& limit, std::uint32_t streams_max) {
  if (limit.scope == FrameScope::kConnection) return limit.burst;
  return (std::uint64_t{limit.burst} * streams_max + kRobotStreamsMax - 1) / kRobotStreamsMax;
}

constexpr bool TableIsSound() {
  for (std::size_t i = 0; i < kFrameLimits.size(); ++i) {
    const FrameLimit& limit = kFrameLimits[i];
    if (static_cast<std::size_t>(limit.kind) != i || limit.rate == 0 || limit.burst == 0) {
      return false;
    }
    if (IntervalOf(limit.rate) * limit.rate != std::chrono::seconds(1)) return false;
  }
  return true;
}
static_assert(TableIsSound(), "kFrameLimits is by kind, and its intervals are whole nanoseconds");

}  // namespace

std::uint32_t FrameRates::RateOf(const FrameLimit& limit) const {
  if (limit.scope == FrameScope::kConnection) return limit.rate;
  const std::uint32_t streams = std::max(streams_max_, kRobotStreamsMax) - kRobotStreamsMax;
  return limit.rate + streams + (limit.scope == FrameScope::kCalls ? calls_per_second_ : 0);
}

void FrameRates::NoteSent(SteadyTime now) {
  if (now - sent_at_ > kForSentWait) for_sent_.fill(0);
  sent_at_ = now;
  for (const FrameLimit& limit : kFrameLimits) {
    std::uint16_t& left = for_sent_[static_cast<std::size_t>(limit.kind)];
    left = static_cast<std::uint16_t>(std::min<int>(left + limit.per_sent, kForSentMax));
  }
}

bool FrameRates::TakeForSent(FrameKind kind, SteadyTime now) {
  std::uint16_t& left = for_sent_[static_cast<std::size_t>(kind)];
  if (left == 0 || now - sent_at_ > kForSentWait) return false;
  --left;
  return true;
}

bool FrameRates::Take(FrameKind kind, SteadyTime now) {
  const FrameLimit& limit = LimitOf(kind);
  SteadyTime& full_at = full_at_[static_cast<std::size_t>(kind)];
  const SteadyTime::duration interval = IntervalOf(RateOf(limit));
  const SteadyTime then = std::max(full_at, now) + interval;
  std::uint64_t burst = BurstOf(limit, streams_max_);
  // A peer that may make so many calls per second may make them all at its start.
  if (limit.scope == FrameScope::kCalls) burst = std::max<std::uint64_t>(burst, calls_per_second_);
  if (then - now > interval * static_cast<SteadyTime::rep>(burst)) return false;
  full_at = then;
  return true;
}

}  // namespace uplink::front
