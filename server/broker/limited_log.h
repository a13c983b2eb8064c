#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/cyberwave/topic.h"
#include "server/broker/twin_stream.h"
#include "server/limits/keyed_buckets.h"
#include "server/log/rate_limited.h"

namespace uplink::broker {

/// The key of the budget for the id in a topic: the id with its prefix and kind (twin, environment,
/// run, ping). Empty if the topic has no id.
[[nodiscard]] std::optional<std::size_t> BudgetKeyOf(const cyberwave::Topic& topic);

/// Logs twins whose messages are rejected for their rate.
///
/// Limits:  one line per robot in log::RateLimited::kSpan, so that each of several is named; for
///          all together as many as that class lets through.
/// Thread:  confined to the broker's.
class LimitedLog final {
 public:
  /// `logger` outlives it.
  explicit LimitedLog(const log::Logger& logger) : lines_(logger) {}

  /// One more message of this stream was rejected.
  void Tell(TwinStream& stream, std::string_view why, SteadyTime now);
  /// Takes `amount` from the budget of this topic's id. If the budget is exceeded, returns false
  /// and logs that at times.
  [[nodiscard]] bool Passes(limits::KeyedBuckets& budgets, const cyberwave::Topic& topic,
                            std::size_t amount, SteadyTime now);

 private:
  log::RateLimited lines_;
};

}  // namespace uplink::broker
