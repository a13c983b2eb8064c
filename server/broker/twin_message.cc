#include "server/broker/twin_message.h"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include "schema/cyberwave/topic.h"
#include "schema/model/held_bytes.h"
#include "server/cyberwave/whose.h"
#include "storage/commit_record.h"
#include "storage/origin.h"

namespace uplink::broker {
namespace {

using cyberwave::DurableRecord;
using cyberwave::TopicKind;

constexpr std::int64_t kUsPerMs = 1000;

/// How many records the message may bring at most; they must have room before it is processed.
std::size_t RecordsAtMost(const cyberwave::Judgement& judgement, const TwinStream& stream) {
  if (judgement.rejection() != nullptr ||
      judgement.message_class == cyberwave::MessageClass::kDurable) {
    return 1;
  }
  const bool metrics = judgement.topic.kind == TopicKind::kMetrics && stream.twin != nullptr;
  return metrics ? stream.twin->RecordsAtMost(judgement) : 0;
}

/// What the flow counts of these records of one message: the bytes of its payload, or what they
/// hold where that is more, as of any robot's messages (limits.durable_bytes_*).
std::size_t FlowBytes(std::size_t payload_bytes, std::span<const DurableRecord> records) {
  std::size_t held = 0;
  for (const DurableRecord& record : records) {
    held += std::visit([](const auto& each) { return model::HeldBytes(each); }, record);
  }
  return std::max(payload_bytes, held);
}

storage::CommitContent ContentOf(DurableRecord&& record) {
  return std::visit(
      [](auto&& each) { return storage::CommitContent(std::forward<decltype(each)>(each)); },
      std::move(record));
}

std::vector<storage::CommitRecord> RecordsOf(std::vector<DurableRecord> made,
                                             const ingest::Arrival& arrival) {
  std::vector<storage::CommitRecord> records;
  records.reserve(made.size());
  for (DurableRecord& each : made) {
    records.push_back({.received_at = arrival.system,
                       .content = ContentOf(std::move(each)),
                       .payload = "",
                       .payload_bytes = arrival.payload_bytes});
  }
  // The store may refuse the record, and quarantine then needs the payload. The first of several
  // records carries it.
  if (!records.empty()) records.front().payload = arrival.payload;
  return records;
}

metrics::Became BecameOf(cyberwave::Outcome outcome) {
  switch (outcome) {
    case cyberwave::Outcome::kApplied:
      return metrics::Became::kApplied;
    case cyberwave::Outcome::kSuperseded:
      return metrics::Became::kSuperseded;
    case cyberwave::Outcome::kObserved:
      return metrics::Became::kObserved;
    case cyberwave::Outcome::kStored:
      return metrics::Became::kStored;
    case cyberwave::Outcome::kRejected:  // it does not come so far
    case cyberwave::Outcome::kIgnored:
      break;
  }
  return metrics::Became::kIgnored;
}

/// Counts the fields that were dropped from a message.
void CountDropped(std::span<const model::DroppedField> dropped, metrics::Ledger& ledger) {
  for (const model::DroppedField& field : dropped) {
    ledger.CountDropped(metrics::kUnknownKind, field.reason);
  }
}

/// Counts the fields that were dropped from a good message, and its absurd values.
void CountOdd(const cyberwave::Judgement& judgement, metrics::Ledger& ledger) {
  CountDropped(judgement.dropped, ledger);
  for (const model::UnlistedFields& fields : judgement.unlisted) {
    ledger.CountDropped(metrics::kUnknownKind, fields.reason, fields.fields);
  }
  const metrics::OddCounts odd{.times_unknown = judgement.times_unknown,
                               .control_characters = judgement.control_characters};
  if (odd.any()) ledger.CountOdd(odd);
}

}  // namespace

using ingest::Numbered;

TwinMessage::TwinMessage(const TwinSources& sources, const Known& known)
    : sources_(sources),
      known_(known),
      arrival_{.steady = known.arrived.steady,
               .system = known.arrived.system,
               .payload = known.publish.payload.value_or(std::string_view()),
               .payload_bytes = known.publish.payload_bytes,
               .waits = known.publish.id != 0 ? ingest::Waits::kBroker : ingest::Waits::kNoOne,
               .is_counted = known.is_counted,
               .sampled_unix_ms = known.judgement.head.timestamp_us / kUsPerMs},
      topic_(known.judgement.topic) {}

std::optional<ingest::RecordCost> TwinMessage::Cost() {
  records_max_ = RecordsAtMost(known_.judgement, known_.stream);
  if (records_max_ == 0) return std::nullopt;
  ingest::RecordCost cost{.journal_bytes = arrival_.payload_bytes};
  // A stand-in has budgets of its own.
  if (known_.stream.twin == nullptr) return cost;
  cost.flow_bytes = known_.judgement.rejection() == nullptr ? arrival_.payload_bytes : 0;
  return cost;
}

void TwinMessage::Begin() { sources_.probe.topics[static_cast<std::size_t>(topic_.kind)].Add(); }

std::optional<model::Rejection> TwinMessage::TakeRate() {
  if (known_.exceeds_robots_max) return std::nullopt;
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
  rests_on_store_ = topic_.kind == TopicKind::kMetrics;
  if (applied.records.empty()) return {.records = {}, .became = BecameOf(applied.outcome)};
  ingest::Brought brought;
  if (stream.twin != nullptr) {
    brought.flow_bytes = FlowBytes(arrival_.payload_bytes, applied.records);
  }
  brought.records = RecordsOf(std::move(applied.records), arrival_);
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
