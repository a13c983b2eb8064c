#include "server/limits/keyed_buckets.h"

#include <chrono>

#include "server/log/rate_limited.h"

namespace uplink::limits {
namespace {

constexpr std::chrono::seconds kSweepAtMostEvery{1};

}  // namespace

KeyedBuckets::Answer KeyedBuckets::Take(std::optional<std::size_t> key, std::size_t amount,
                                        SteadyTime now) {
  Budget& budget = Of(key, now);
  if (budget.bucket.TryTake(amount, policy_.bucket(), now)) return Answer::kPasses;
  return budget.logged.Take(now, log::RateLimited::kSpan) ? Answer::kOverAndLog : Answer::kOver;
}

KeyedBuckets::Budget& KeyedBuckets::Of(std::optional<std::size_t> key, SteadyTime now) {
  if (!key) return shared_;
  if (const auto found = budgets_.find(*key); found != budgets_.end()) return found->second;
  if (budgets_.size() >= policy_.keys_max && sweeps_.Take(now, kSweepAtMostEvery)) {
    std::erase_if(budgets_, [now](const auto& each) { return each.second.bucket.IsFull(now); });
  }
  return budgets_.size() < policy_.keys_max ? budgets_[*key] : shared_;
}

}  // namespace uplink::limits
