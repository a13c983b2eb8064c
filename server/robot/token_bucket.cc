#include "server/robot/token_bucket.h"

#include <algorithm>
#include <chrono>

namespace uplink::robot {
namespace {

/// What a bucket takes longer for than this is as good as never, and nothing overflows.
constexpr double kFillMaxSeconds = 1e8;

SteadyTime::duration TimeFor(std::uint64_t tokens, const BucketSize& size) {
  const double seconds = static_cast<double>(tokens) / static_cast<double>(size.rate);
  return std::chrono::duration_cast<SteadyTime::duration>(
      std::chrono::duration<double>(std::min(seconds, kFillMaxSeconds)));
}

}  // namespace

SteadyTime TokenBucket::PassesAt(std::uint64_t cost, const BucketSize& size, SteadyTime now) const {
  if (size.rate == 0 || full_at_ <= now) return now;
  const std::uint64_t may_lack = size.burst - std::min(size.burst, cost);
  // A smaller bucket than before may lack more than it holds: it is empty, then.
  return full_at_ - TimeFor(may_lack, size);
}

void TokenBucket::Take(std::uint64_t cost, const BucketSize& size, SteadyTime now) {
  if (size.rate == 0) return;
  full_at_ = std::max(full_at_, now) + TimeFor(cost, size);
}

}  // namespace uplink::robot
