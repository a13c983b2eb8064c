#include "server/broker/byte_budgets.h"

#include <functional>
#include <string>

#include "schema/model/cyberwave/uuid.h"
#include "server/broker/limits.h"
#include "server/log/rate_limited.h"

namespace uplink::broker {
namespace {

constexpr std::chrono::seconds kSweepAtMostEvery{1};

std::size_t KeyOf(const cyberwave::Topic& topic) {
  return topic.kind == cyberwave::TopicKind::kPing ? std::hash<std::string>{}(topic.name)
                                                   : std::hash<model::cyberwave::Uuid>{}(topic.id);
}

}  // namespace

ByteBudgets::Answer ByteBudgets::Take(const cyberwave::Topic& topic, std::size_t bytes,
                                      SteadyTime now) {
  if (bytes < kBudgetedBytesMin) return Answer::kPasses;
  Budget& budget = Of(topic, now);
  if (budget.bucket.PassesAt(bytes, kBytesOfId, now) <= now) {
    budget.bucket.Take(bytes, kBytesOfId, now);
    return Answer::kPasses;
  }
  if (budget.told_at && now - *budget.told_at < log::RateLimited::kSpan) return Answer::kOver;
  budget.told_at = now;
  return Answer::kOverAndTell;
}

ByteBudgets::Budget& ByteBudgets::Of(const cyberwave::Topic& topic, SteadyTime now) {
  if (!topic.identified) return shared_;
  const std::size_t key = KeyOf(topic);
  if (const auto found = budgets_.find(key); found != budgets_.end()) return found->second;
  if (budgets_.size() >= kBudgetsMax && now - swept_at_ >= kSweepAtMostEvery) {
    swept_at_ = now;
    // A full one is as good as none.
    std::erase_if(budgets_, [now](const auto& each) {
      return each.second.bucket.PassesAt(kBytesOfId.burst, kBytesOfId, now) <= now;
    });
  }
  return budgets_.size() < kBudgetsMax ? budgets_[key] : shared_;
}

}  // namespace uplink::broker
