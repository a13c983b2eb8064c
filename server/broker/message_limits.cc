#include "server/broker/message_limits.h"

namespace uplink::broker {
namespace {

/// At QoS 1 its publisher waits for our ack.
bool IsAcked(const mqtt::Publish& publish) { return publish.id != 0; }

/// Why the twin sends too much; if it does not, tokens are taken for a message that may bring so
/// many records.
std::optional<model::Rejection> LimitOf(const cyberwave::Judgement& judgement, TwinStream& stream,
                                        std::size_t records, cyberwave::JournalFill fill,
                                        SteadyTime now) {
  if (auto limited = stream.rates->Limit(judgement, fill, now)) return limited;
  const bool faults = judgement.topic.kind == cyberwave::TopicKind::kMetrics &&
                      judgement.rejection() == nullptr && records > 0;
  return faults ? stream.rates->LimitFaults(records, now) : std::nullopt;
}

}  // namespace

bool MessageLimits::ExceedsUnknownSenderBudget(const Message& message, const TwinStream& stream) {
  if (stream.twin != nullptr || message.judgement.rejection() == nullptr) return false;
  return !context_.log.Passes(strangers_, message.judgement.topic, 1, message.arrived);
}

std::optional<model::Rejection> MessageLimits::Limit(const Message& message, TwinStream& stream,
                                                     std::size_t records) {
  const SteadyTime now = context_.clock.Steady();
  const bool journal_short = context_.journal_over_half();
  const auto fill =
      journal_short ? cyberwave::JournalFill::kOverHalf : cyberwave::JournalFill::kUpToHalf;
  if (auto limited = LimitOf(message.judgement, stream, records, fill, now)) {
    context_.log.Tell(stream, limited->detail, now);
    return limited;
  }
  if (records > 0 && stream.twin == nullptr && ExceedsScopeBudget(message, journal_short)) {
    return model::Rejection{.reason = model::RejectReason::kRateLimited, .field = {}, .detail = {}};
  }
  return std::nullopt;
}

bool MessageLimits::ExceedsScopeBudget(const Message& message, bool journal_short) {
  // Rejected messages have the budget of strangers.
  if (message.judgement.rejection() != nullptr) return false;
  if (IsAcked(message.publish) && !journal_short) return false;
  const cyberwave::Topic& topic = message.judgement.topic;
  return !context_.log.Passes(scope_records_, topic, 1, message.arrived) ||
         !context_.log.Passes(scope_bytes_, topic, message.publish.payload_bytes, message.arrived);
}

}  // namespace uplink::broker
