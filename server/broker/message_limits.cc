#include "server/broker/message_limits.h"

#include "server/broker/message_cost.h"

namespace uplink::broker {
namespace {

/// Its publisher waits for our ack.
bool IsAcked(const mqtt::Publish& publish) { return publish.id != 0; }

}  // namespace

bool MessageLimits::ExceedsUnknownSenderBudget(const Message& message, const TwinStream& stream) {
  if (stream.twin != nullptr || message.judgement.rejection() == nullptr) return false;
  return !context_.log.Passes(strangers_, message.judgement.topic, 1, message.arrived,
                              "rejected messages of no robot");
}

std::optional<model::RejectReason> MessageLimits::Limit(const Message& message, TwinStream& stream,
                                                        std::size_t records) {
  const SteadyTime now = context_.clock.Steady();
  const bool journal_short = context_.journal_over_half();
  const auto fill =
      journal_short ? cyberwave::JournalFill::kOverHalf : cyberwave::JournalFill::kUpToHalf;
  if (const auto limited = LimitOf(message.judgement, stream, records, fill, now)) {
    context_.log.Tell(stream, limited->detail, now);
    return limited->reason;
  }
  if (records > 0 && stream.twin == nullptr && ExceedsScopeBudget(message, journal_short)) {
    return model::RejectReason::kRateLimited;
  }
  return std::nullopt;
}

bool MessageLimits::IsPastFlow(const Message& message, TwinStream& stream) {
  if (stream.twin == nullptr) return false;
  const robot::DurableFlow& flow = stream.robot->flow;
  const SteadyTime now = context_.clock.Steady();
  // Where nothing may be stored at all, it is no matter of this twin.
  if (flow.LookAtDisk(now).by != robot::HeldBack::kNone) return false;
  const bool is_short = flow.disk_limits() || context_.journal_over_half();
  if (IsAcked(message.publish) && !is_short) return false;
  const bool is_kept = message.judgement.rejection() == nullptr;
  const robot::HeldBack by =
      flow.LookAt(is_kept ? message.publish.payload_bytes : 0, FlowLimitsNow(), now).by;
  if (by == robot::HeldBack::kNone) return false;
  context_.log.Tell(stream,
                    by == robot::HeldBack::kDisk
                        ? "more than it may store while the store's disk is short (store.free_min)"
                        : "more than is stored of one robot (limits.durable_*)",
                    now);
  return true;
}

bool MessageLimits::ExceedsScopeBudget(const Message& message, bool journal_short) {
  // What is rejected has the budget of strangers.
  if (message.judgement.rejection() != nullptr) return false;
  if (IsAcked(message.publish) && !journal_short) return false;
  const cyberwave::Topic& topic = message.judgement.topic;
  return !context_.log.Passes(scope_records_, topic, 1, message.arrived, "messages to store") ||
         !context_.log.Passes(scope_bytes_, topic, message.publish.payload_bytes, message.arrived,
                              "bytes to store");
}

void MessageLimits::TakeFlow(TwinStream& stream, std::span<const storage::CommitRecord> records,
                             std::size_t payload_bytes) const {
  if (stream.twin == nullptr) return;
  const robot::FlowLimits limits = FlowLimitsNow();
  const SteadyTime now = context_.clock.Steady();
  const std::size_t bytes = FlowBytes(payload_bytes, records);
  robot::DurableFlow& flow = stream.robot->flow;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::size_t more = i == 0 ? bytes : 0;
    // What passes at QoS 1 beyond the flow is kept beside it, and leaves no debt: a backlog of an
    // outage is honest.
    if (flow.LookAt(more, limits, now).by == robot::HeldBack::kNone) {
      flow.Take(more, limits, now);
    } else {
      flow.CountKept(more);
    }
  }
}

}  // namespace uplink::broker
