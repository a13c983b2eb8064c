#include "server/broker/twin_message.h"

#include <utility>

#include "schema/cyberwave/topic.h"
#include "server/broker/message_cost.h"
#include "server/broker/outcome.h"
#include "server/broker/records_of.h"
#include "server/cyberwave/whose.h"
#include "storage/origin.h"

namespace uplink::broker {

using ingest::Numbered;

TwinMessage::TwinMessage(const TwinSources& sources, const Known& known)
    : sources_(sources),
      known_(known),
      arrival_{.steady = known.arrived.steady,
               .system = known.arrived.system,
               .payload = known.publish.payload.value_or(std::string_view()),
               .payload_bytes = known.publish.payload_bytes,
               .waits = known.publish.id != 0 ? ingest::Waits::kBroker : ingest::Waits::kNobody,
               .is_counted = known.is_counted},
      topic_(known.judgement.topic) {}

std::optional<ingest::RecordCost> TwinMessage::Cost() {
  records_max_ = RecordsAtMost(known_.judgement, known_.stream);
  if (records_max_ == 0) return std::nullopt;
  ingest::RecordCost cost{.journal_bytes = arrival_.payload_bytes};
  // What stands in the place of no robot has budgets of its own.
  if (known_.stream.twin == nullptr) return cost;
  cost.flow_bytes = known_.judgement.rejection() == nullptr ? arrival_.payload_bytes : 0;
  return cost;
}

void TwinMessage::Begin() { sources_.probe.topics[static_cast<std::size_t>(topic_.kind)].Add(); }

std::optional<model::Rejection> TwinMessage::TakeRate() {
  if (known_.is_one_too_many) return std::nullopt;
  return sources_.limits.Limit(judged(), known_.stream, records_max_);
}

Numbered TwinMessage::RejectLimited(const model::Rejection& /*rejection*/) {
  sources_.commits.SettleAtOnce(known_.delivered, &known_.stream);
  return Numbered::kSettled;
}

ingest::Quarantined TwinMessage::Reject(const model::Rejection& /*rejection*/) {
  ingest::Quarantined row{.payload_may_be_kept =
                              known_.judgement.may_be_kept && known_.publish.payload.has_value()};
  if (known_.stream.twin != nullptr) row.flow_bytes = 0;
  return row;
}

ingest::Brought TwinMessage::Take() {
  CountOdd(known_.judgement, sources_.ledger);
  TwinStream& stream = known_.stream;
  cyberwave::Applied applied =
      stream.twin == nullptr
          ? cyberwave::ApplyToNoRobot(std::move(known_.judgement))
          : sources_.twins.Apply(*stream.twin, std::move(known_.judgement), known_.arrived);
  CountDropped(applied.dropped, sources_.ledger);
  stream.robot->state.CountDropped(applied.without_room);
  rests_on_store_ = topic_.kind == cyberwave::TopicKind::kMetrics;
  if (applied.records.empty()) return {.records = {}, .became = BecameOf(applied.outcome)};
  ingest::Brought brought{
      .records = RecordsOf(std::move(applied.records), known_.publish, known_.arrived.system)};
  if (stream.twin != nullptr) {
    brought.flow_bytes = FlowBytes(arrival_.payload_bytes, brought.records);
  }
  return brought;
}

Numbered TwinMessage::Number(std::vector<storage::CommitRecord>& records,
                             std::optional<model::RejectReason> rejected) {
  const storage::OriginRef origin = storage::OriginOf(
      model::MessageSource::kCyberwave, cyberwave::KeptTopic(known_.publish.topic, topic_),
      sources_.commits.hold());
  for (storage::CommitRecord& record : records) record.origin = origin;
  return sources_.commits.Number(known_.stream, known_.delivered, records, rejected)
             ? Numbered::kWaiting
             : Numbered::kLost;
}

void TwinMessage::Settle(metrics::Became /*became*/) {
  if (rests_on_store_) {
    sources_.commits.SettleAfterCommit(known_.delivered, known_.stream);
  } else {
    sources_.commits.SettleAtOnce(known_.delivered, &known_.stream);
  }
}

}  // namespace uplink::broker
