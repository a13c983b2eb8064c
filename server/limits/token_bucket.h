#pragma once

#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::limits {

/// How fast a bucket fills, and how much it holds. A value.
struct BucketSize {
  /// Tokens per second; 0: there is no bucket, and everything passes.
  std::uint64_t rate = 0;
  std::uint64_t burst = 0;

  friend bool operator==(const BucketSize&, const BucketSize&) = default;
};

/// A bucket of tokens, full at first. It keeps only the time at which it will be full again, so it
/// needs no timer, and another size takes effect with the next call. Confined to its owner.
class TokenBucket final {
 public:
  /// When `cost` tokens can be taken: at or before `now` if they are there. A full bucket gives any
  /// cost, also more than it holds.
  [[nodiscard]] SteadyTime PassesAt(std::uint64_t cost, const BucketSize& size,
                                    SteadyTime now) const;
  /// Takes them, whether they are there or not.
  void Take(std::uint64_t cost, const BucketSize& size, SteadyTime now);
  /// Takes them if they are there.
  [[nodiscard]] bool TryTake(std::uint64_t cost, const BucketSize& size, SteadyTime now) {
    if (PassesAt(cost, size, now) > now) return false;
    Take(cost, size, now);
    return true;
  }
  /// Whether it is full, like one that was never used.
  [[nodiscard]] bool IsFull(SteadyTime now) const { return full_at_ <= now; }

 private:
  /// When it is full again with this size from now on. It lacks the tokens it lacked before, though
  /// no more than the size holds, unless it gave more than it held: then it lacks all of them.
  [[nodiscard]] SteadyTime FullAt(const BucketSize& size, SteadyTime now) const;

  SteadyTime full_at_{};
  /// The size for which full_at_ was computed.
  BucketSize size_;
};

}  // namespace uplink::limits
