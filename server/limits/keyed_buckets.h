#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/limits/recent_times.h"
#include "server/limits/token_bucket.h"

namespace uplink::limits {

/// What each key may have. A value.
struct KeyedLimit {
  /// Of what, as the log says it; a word of ours.
  std::string_view of;
  BucketSize each;
  /// Keys that have a bucket of their own.
  std::size_t keys_max = 0;
};

/// A bucket for each key. At `keys_max` those that are full again are forgotten; keys beyond share
/// one bucket. Up to `keys_max` an invented key has a burst of its own: what all keys use together
/// needs a bound besides.
///
/// Thread:  confined to its owner.
class KeyedBuckets final {
 public:
  explicit KeyedBuckets(const KeyedLimit& limit) : limit_(limit) {}

  enum class Answer : std::uint8_t {
    kPasses,
    kOver,
    /// The same, and the log is to say so: the first one of the key within log::RateLimited::kSpan.
    kOverAndTell,
  };
  /// Takes so much, if the key may have it. `key` is a hash: two that share it share a bucket.
  /// Nothing: the bucket of those beyond.
  [[nodiscard]] Answer Take(std::optional<std::size_t> key, std::size_t amount, SteadyTime now);

  [[nodiscard]] const KeyedLimit& limit() const { return limit_; }

 private:
  struct Budget {
    TokenBucket bucket;
    RecentTimes<1> told;
  };
  [[nodiscard]] Budget& Of(std::optional<std::size_t> key, SteadyTime now);

  const KeyedLimit limit_;
  std::unordered_map<std::size_t, Budget> budgets_;
  Budget shared_;
  RecentTimes<1> sweeps_;
};

}  // namespace uplink::limits
