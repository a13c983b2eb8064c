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

/// The key by which the id in a topic has a budget: the id under its prefix and of its kind (twin,
/// environment, run, ping). Nothing if the topic has no id.
[[nodiscard]] std::optional<std::size_t> BudgetKeyOf(const cyberwave::Topic& topic);

/// The lines that name twins whose messages are rejected for their rate.
///
/// Limits:  one line of a robot in log::RateLimited::kSpan, so that each of several is named; and
///          as many of all together as that class lets through.
/// Thread:  confined to the broker's.
class LimitedLog final {
 public:
  /// `logger` outlives it.
  explicit LimitedLog(const log::Logger& logger) : lines_(logger) {}

  /// One more message of this stream was rejected.
  void Tell(TwinStream& stream, std::string_view why, SteadyTime now);
  /// Takes so much of the budget that this topic's id has. False, and told at times, if it is over
  /// it.
  [[nodiscard]] bool Passes(limits::KeyedBuckets& budgets, const cyberwave::Topic& topic,
                            std::size_t amount, SteadyTime now);

 private:
  log::RateLimited lines_;
};

}  // namespace uplink::broker
