#include "server/broker/limited_log.h"

#include <string>

#include <fmt/core.h>

namespace uplink::broker {

void LimitedLog::Tell(TwinStream& stream, std::string_view why, SteadyTime now) {
  if (stream.limited_told_at && now - *stream.limited_told_at < log::RateLimited::kSpan) return;
  if (lines_.Write(log::Level::kWarn, "twin_limited", {{"robot", stream.ruri()}, {"why", why}})) {
    stream.limited_told_at = now;
  }
}

bool LimitedLog::Passes(IdBudgets& budgets, const cyberwave::Topic& topic, std::size_t amount,
                        SteadyTime now, std::string_view of) {
  const IdBudgets::Answer answer = budgets.Take(topic, amount, now);
  if (answer == IdBudgets::Answer::kOverAndTell) {
    const bool is_ping = topic.kind == cyberwave::TopicKind::kPing;
    lines_.Write(log::Level::kWarn, "twin_limited",
                 {{"id", is_ping ? topic.name : topic.id.ToText()},
                  {"why", fmt::format("more than {} {} per second, after {} at once",
                                      budgets.size().rate, of, budgets.size().burst)}});
  }
  return answer == IdBudgets::Answer::kPasses;
}

}  // namespace uplink::broker
