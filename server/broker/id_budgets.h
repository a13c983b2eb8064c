#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include "schema/base/clock.h"
#include "schema/cyberwave/topic.h"
#include "server/limits/token_bucket.h"

namespace uplink::broker {

/// How much of something each id in topics may have, under each prefix and of each kind (twin,
/// environment, run, ping): a budget of its own that fills up again.
///
/// Limits:  kBudgetsMax ids; those beyond share one budget, and so do all that is no id.
/// Thread:  confined to its owner's.
class IdBudgets final {
 public:
  explicit IdBudgets(const limits::BucketSize& size) : size_(size) {}

  enum class Answer : std::uint8_t {
    kPasses,
    kOver,
    /// The same, and the log is to say so: the first one since log::RateLimited::kSpan.
    kOverAndTell,
  };
  /// So much for a message whose topic was read as this one.
  [[nodiscard]] Answer Take(const cyberwave::Topic& topic, std::size_t amount, SteadyTime now);

  [[nodiscard]] const limits::BucketSize& size() const { return size_; }

 private:
  struct Budget {
    limits::TokenBucket bucket;
    std::optional<SteadyTime> told_at;
  };
  [[nodiscard]] Budget& Of(const cyberwave::Topic& topic, SteadyTime now);

  const limits::BucketSize size_;
  /// By a hash: two ids that share it share a budget.
  std::unordered_map<std::size_t, Budget> budgets_;
  Budget shared_;
  SteadyTime swept_at_{};
};

}  // namespace uplink::broker
