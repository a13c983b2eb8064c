#include "server/broker/id_budgets.h"

#include <string>

#include <absl/hash/hash.h>

#include "server/broker/limits.h"
#include "server/log/rate_limited.h"

namespace uplink::broker {
namespace {

constexpr std::chrono::seconds kSweepAtMostEvery{1};

/// Topics of a twin are of one kind.
std::size_t KindOf(const cyberwave::Topic& topic) {
  return cyberwave::IsOfTwin(topic.kind) ? 0 : 1 + static_cast<std::size_t>(topic.kind);
}

std::size_t KeyOf(const cyberwave::Topic& topic) {
  return absl::HashOf(KindOf(topic), topic.prefix, topic.id.bytes(),
                      topic.kind == cyberwave::TopicKind::kPing ? topic.name : std::string());
}

}  // namespace

IdBudgets::Answer IdBudgets::Take(const cyberwave::Topic& topic, std::size_t amount,
                                  SteadyTime now) {
  Budget& budget = Of(topic, now);
  if (budget.bucket.PassesAt(amount, size_, now) <= now) {
    budget.bucket.Take(amount, size_, now);
    return Answer::kPasses;
  }
  if (budget.told_at && now - *budget.told_at < log::RateLimited::kSpan) return Answer::kOver;
  budget.told_at = now;
  return Answer::kOverAndTell;
}

IdBudgets::Budget& IdBudgets::Of(const cyberwave::Topic& topic, SteadyTime now) {
  if (!topic.identified) return shared_;
  const std::size_t key = KeyOf(topic);
  if (const auto found = budgets_.find(key); found != budgets_.end()) return found->second;
  if (budgets_.size() >= kBudgetsMax && now - swept_at_ >= kSweepAtMostEvery) {
    swept_at_ = now;
    // A full one is as good as none.
    std::erase_if(budgets_, [this, now](const auto& each) {
      return each.second.bucket.PassesAt(size_.burst, size_, now) <= now;
    });
  }
  return budgets_.size() < kBudgetsMax ? budgets_[key] : shared_;
}

}  // namespace uplink::broker
