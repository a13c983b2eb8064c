#include "server/uncrew/drone_message.h"

#include <utility>

#include <fmt/format.h>

#include "server/journal/entry.h"
#include "server/robot/limits.h"
#include "server/uncrew/limits.h"

namespace uplink::uncrew {

using ingest::Numbered;

std::optional<ingest::RecordCost> DroneMessage::Cost() {
  if (const model::Rejection* rejection = plan_.judged.rejection()) {
    return ingest::RecordCost{
        .journal_bytes = journal::CostOf(plan_.arrival.payload_bytes, *rejection), .flow_bytes = 0};
  }
  if (plan_.records.empty()) return std::nullopt;
  ingest::RecordCost cost{.flow_bytes = plan_.arrival.payload_bytes};
  for (const storage::CommitRecord& record : plan_.records) {
    cost.journal_bytes += journal::CostOf(record);
  }
  return cost;
}

std::optional<model::Rejection> DroneMessage::TakeRate() {
  if (plan_.rate == nullptr || plan_.rate->TryTake(1, kLiveRate, plan_.now)) return std::nullopt;
  retry_after_ =
      std::chrono::ceil<milliseconds>(plan_.rate->PassesAt(1, kLiveRate, plan_.now) - plan_.now);
  return limited_ = model::Rejection{
             .reason = model::RejectReason::kRateLimited,
             .field = {},
             .detail = fmt::format("more than {} live samples per second", kLiveRate.rate)};
}

Numbered DroneMessage::RejectLimited(const model::Rejection& rejection) {
  plan_.ledger.CountRejected(metrics::kUnknownKind, rejection.reason);
  return Numbered::kSettled;
}

ingest::Quarantined DroneMessage::Reject(const model::Rejection& rejection) {
  plan_.ledger.CountRejected(metrics::kUnknownKind, rejection.reason);
  return {.payload_may_be_kept = plan_.judged.may_be_kept, .flow_bytes = 0};
}

ingest::Brought DroneMessage::Take() {
  for (const model::DroppedField& field : plan_.judged.dropped) {
    plan_.ledger.CountDropped(metrics::kUnknownKind, field.reason);
  }
  for (const model::UnlistedFields& fields : plan_.judged.unlisted) {
    plan_.ledger.CountDropped(metrics::kUnknownKind, fields.reason, fields.fields);
  }
  const metrics::OddCounts odd{.times_unknown = plan_.judged.times_unknown,
                               .enumerants_unrecognized = plan_.judged.enumerants_unrecognized,
                               .control_characters = plan_.judged.control_characters};
  if (odd.any()) plan_.ledger.CountOdd(odd);
  if (plan_.records.empty()) return {.records = {}, .became = plan_.became};
  return {.records = std::move(plan_.records), .flow_bytes = plan_.arrival.payload_bytes};
}

Numbered DroneMessage::Number(std::vector<storage::CommitRecord>& records,
                              std::optional<model::RejectReason> rejected) {
  const storage::OriginRef origin = storage::OriginOf(
      model::MessageSource::kUncrew, model::uncrew::RowOf(plan_.judged.type).method);
  for (storage::CommitRecord& record : records) record.origin = origin;
  ticket_ = plan_.waiting.Add(plan_.mark, records, rejected);
  return Numbered::kWaiting;
}

}  // namespace uplink::uncrew
