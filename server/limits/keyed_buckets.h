#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/limits/policies.h"
#include "server/limits/recent_times.h"
#include "server/limits/token_bucket.h"

namespace uplink::limits {

/// A bucket for each key of a policy. At `keys_max` keys it forgets the buckets that are full
/// again; keys beyond share one bucket. Up to `keys_max` each invented key has a burst of its own,
/// so what all keys use together needs another bound.
///
/// Thread:  confined to its owner.
class KeyedBuckets final {
 public:
  explicit KeyedBuckets(const Policy& policy) : policy_(policy) {}

  enum class Answer : std::uint8_t {
    kPasses,
    kOver,
    /// Over, and to be logged: it is the key's first within log::RateLimited::kSpan.
    kOverAndLog,
  };
  /// Takes `amount` if the key may have it. `key` is a hash: keys with the same hash share a
  /// bucket. No key: the bucket that the keys beyond `keys_max` share.
  [[nodiscard]] Answer Take(std::optional<std::size_t> key, std::size_t amount, SteadyTime now);

  [[nodiscard]] const Policy& policy() const { return policy_; }

 private:
  struct Budget {
    TokenBucket bucket;
    RecentTimes<1> logged;
  };
  [[nodiscard]] Budget& Of(std::optional<std::size_t> key, SteadyTime now);

  const Policy policy_;
  std::unordered_map<std::size_t, Budget> budgets_;
  Budget shared_;
  RecentTimes<1> sweeps_;
};

}  // namespace uplink::limits
