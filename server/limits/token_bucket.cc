#include "server/limits/token_bucket.h"

#include <algorithm>
#include <chrono>

namespace uplink::limits {
namespace {

/// Times to fill are cut to this, which is as good as never, so that nothing overflows.
constexpr double kFillMaxSeconds = 1e8;

SteadyTime::duration TimeFor(std::uint64_t tokens, const BucketSize& size) {
  const double seconds = static_cast<double>(tokens) / static_cast<double>(size.rate);
  return std::chrono::duration_cast<SteadyTime::duration>(
      std::chrono::duration<double>(std::min(seconds, kFillMaxSeconds)));
}

/// The tokens that a bucket of this rate gets in that time.
std::uint64_t TokensOf(SteadyTime::duration time, const BucketSize& size) {
  const double seconds = std::chrono::duration<double>(time).count();
  return static_cast<std::uint64_t>(seconds * static_cast<double>(size.rate));
}

}  // namespace

SteadyTime TokenBucket::FullAt(const BucketSize& size, SteadyTime now) const {
  if (size == size_ || full_at_ <= now) return full_at_;
  const std::uint64_t lacks = TokensOf(full_at_ - now, size_);
  // By more than the rounding of the division.
  const bool overdrawn = lacks > 0 && lacks - 1 > size_.burst;
  return now + TimeFor(overdrawn ? lacks : std::min(lacks, size.burst), size);
}

SteadyTime TokenBucket::PassesAt(std::uint64_t cost, const BucketSize& size, SteadyTime now) const {
  if (size.rate == 0 || full_at_ <= now) return now;
  const std::uint64_t may_lack = size.burst - std::min(size.burst, cost);
  return FullAt(size, now) - TimeFor(may_lack, size);
}

void TokenBucket::Take(std::uint64_t cost, const BucketSize& size, SteadyTime now) {
  if (size.rate == 0) return;
  full_at_ = std::max(FullAt(size, now), now) + TimeFor(cost, size);
  size_ = size;
}

}  // namespace uplink::limits
