#include "server/broker/limited_log.h"

#include <string>

#include <absl/hash/hash.h>
#include <fmt/core.h>

namespace uplink::broker {

std::optional<std::size_t> BudgetKeyOf(const cyberwave::Topic& topic) {
  if (!topic.identified) return std::nullopt;
  // Topics of a twin are of one kind.
  const std::size_t kind =
      cyberwave::IsOfTwin(topic.kind) ? 0 : 1 + static_cast<std::size_t>(topic.kind);
  return absl::HashOf(kind, topic.prefix, topic.id.bytes(),
                      topic.kind == cyberwave::TopicKind::kPing ? topic.name : std::string());
}

void LimitedLog::Tell(TwinStream& stream, std::string_view why, SteadyTime now) {
  if (stream.limited_told.IsFull(now, log::RateLimited::kSpan)) return;
  if (lines_.Write(log::Level::kWarn, "twin_limited", {{"robot", stream.ruri()}, {"why", why}})) {
    stream.limited_told.Note(now);
  }
}

bool LimitedLog::Passes(limits::KeyedBuckets& budgets, const cyberwave::Topic& topic,
                        std::size_t amount, SteadyTime now) {
  using enum limits::KeyedBuckets::Answer;
  const auto answer = budgets.Take(BudgetKeyOf(topic), amount, now);
  if (answer == kOverAndLog) {
    const limits::Policy& policy = budgets.policy();
    const bool is_ping = topic.kind == cyberwave::TopicKind::kPing;
    lines_.Write(log::Level::kWarn, "twin_limited",
                 {{"id", is_ping ? topic.name : topic.id.ToText()},
                  {"why", fmt::format("more than {} {} per second, after {} at once", policy.most,
                                      policy.of, policy.at_once)}});
  }
  return answer == kPasses;
}

}  // namespace uplink::broker
