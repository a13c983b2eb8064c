#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include "schema/base/clock.h"
#include "schema/cyberwave/topic.h"
#include "server/robot/token_bucket.h"

namespace uplink::broker {

/// How many bytes at QoS 0 each id in topics may have us look into. To read a large payload takes
/// longer than its publisher needs to send it, and meanwhile the broker drops what others say. At
/// QoS 1 our acks hold publishers back.
///
/// Limits:  kBudgetsMax ids; those beyond share one budget, and so do all that is no id.
/// Thread:  confined to its owner's.
class ByteBudgets final {
 public:
  enum class Answer : std::uint8_t {
    kPasses,
    kOver,
    /// The same, and the log is to say so: the first one since log::RateLimited::kSpan.
    kOverAndTell,
  };
  /// A payload of so many bytes, whose topic was read as this one. Small ones always pass.
  [[nodiscard]] Answer Take(const cyberwave::Topic& topic, std::size_t bytes, SteadyTime now);

 private:
  struct Budget {
    robot::TokenBucket bucket;
    std::optional<SteadyTime> told_at;
  };
  [[nodiscard]] Budget& Of(const cyberwave::Topic& topic, SteadyTime now);

  /// By a hash of the id: two ids that share it share a budget.
  std::unordered_map<std::size_t, Budget> budgets_;
  Budget shared_;
  SteadyTime swept_at_{};
};

}  // namespace uplink::broker
