#pragma once

#include <string_view>

#include "schema/cyberwave/topic.h"
#include "server/broker/id_budgets.h"
#include "server/broker/twin_stream.h"
#include "server/log/rate_limited.h"

namespace uplink::broker {

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
  /// it; `of` says what the budget is of.
  [[nodiscard]] bool Passes(IdBudgets& budgets, const cyberwave::Topic& topic, std::size_t amount,
                            SteadyTime now, std::string_view of);

 private:
  log::RateLimited lines_;
};

}  // namespace uplink::broker
