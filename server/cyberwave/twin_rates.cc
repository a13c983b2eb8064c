#include "server/cyberwave/twin_rates.h"

#include <variant>

#include "server/robot/rates.h"

namespace uplink::cyberwave {
namespace {

bool IsLogLine(const Judgement& judgement) {
  if (judgement.topic.kind == TopicKind::kDriverLog) return true;
  const model::cyberwave::Body* body = judgement.body();
  return body != nullptr && std::holds_alternative<model::cyberwave::DriverLog>(*body);
}

}  // namespace

std::optional<model::Rejection> TwinRates::Limit(const Judgement& judgement, JournalFill fill,
                                                 SteadyTime now) {
  const bool durable = judgement.message_class == MessageClass::kDurable;
  if (durable && fill == JournalFill::kUpToHalf) return std::nullopt;
  if (messages_.PassesAt(1, kMessagesOfTwin, now) > now) return robot::RateLimited(kMessagesOfTwin);
  if (IsLogLine(judgement) && !log_lines_.TryTake(1, kLogLinesOfTwin, now)) {
    return robot::RateLimited(kLogLinesOfTwin);
  }
  messages_.Take(1, kMessagesOfTwin, now);
  return std::nullopt;
}

std::optional<model::Rejection> TwinRates::LimitFaults(std::size_t changes, SteadyTime now) {
  if (fault_changes_.TryTake(changes, kFaultChangesOfTwin, now)) return std::nullopt;
  return robot::RateLimited(kFaultChangesOfTwin);
}

}  // namespace uplink::cyberwave
