#include "storage/postgres/history_rows.h"

#include <utility>

#include "schema/json/text.h"
#include "storage/numbers.h"

namespace uplink::storage::postgres {
namespace {

// In each, `(SELECT currval ...)` is read once a statement.
constexpr std::string_view kInsertFaults =
    "INSERT INTO uplinkd.faults_history (ruri, received_at, entry, fleet, session, seq, sampled_ms,"
    " fault_id, source, severity, active, category, description, suggested_action)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, sampled_ms, fault_id, source, severity, active, category, description, suggested_action"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::bigint[], $8::text[], $9::text[], $10::int[], $11::bool[], $12::text[], $13::text[],"
    " $14::text[]) AS u (ruri, received_at, place, fleet, session, seq, sampled_ms, fault_id,"
    " source, severity, active, category, description, suggested_action)";

constexpr std::string_view kInsertEvents =
    "INSERT INTO uplinkd.events (ruri, received_at, entry, fleet, session, seq, sampled_ms, kind,"
    " detail)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, sampled_ms, kind, detail"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::bigint[], $8::text[], $9::text[])"
    " AS u (ruri, received_at, place, fleet, session, seq, sampled_ms, kind, detail)";

constexpr std::string_view kInsertMessages =
    "INSERT INTO uplinkd.messages (ruri, received_at, entry, fleet, session, seq, sampled_ms,"
    " level, message)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, sampled_ms, level, message"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::bigint[], $8::int[], $9::text[])"
    " AS u (ruri, received_at, place, fleet, session, seq, sampled_ms, level, message)";

constexpr std::string_view kInsertReports =
    "INSERT INTO uplinkd.mission_reports (ruri, received_at, entry, fleet, session, seq,"
    " mission_id, run_id, status, report)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, mission_id, run_id, status, report"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::text[], $8::text[], $9::int[], $10::text[])"
    " AS u (ruri, received_at, place, fleet, session, seq, mission_id, run_id, status, report)";

constexpr std::string_view kInsertQuarantine =
    "INSERT INTO uplinkd.quarantine (ruri, received_at, entry, fleet, session, seq, reason, field,"
    " detail, payload_bytes, payload)"
    " SELECT ruri, received_at, (SELECT currval('uplinkd.batches') << 20) + place, fleet, session,"
    " seq, reason, field, detail, payload_bytes, payload"
    " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::uuid[], $6::bigint[],"
    " $7::int[], $8::text[], $9::text[], $10::bigint[], $11::bytea[])"
    " AS u (ruri, received_at, place, fleet, session, seq, reason, field, detail, payload_bytes,"
    " payload)";

/// Adds the columns in the order of the statement's parameters.
template <typename... Columns>
void Emit(std::string_view sql, ReportColumns& common, std::vector<Call>& calls,
          Columns&... columns) {
  if (common.empty()) return;
  Call call{sql, {}};
  common.MoveInto(call.parameters);
  (call.parameters.Add(std::move(columns)), ...);
  calls.push_back(std::move(call));
}

}  // namespace

void ReportColumns::Add(const CommitRecord& record, std::int32_t place) {
  ruri_.Text(record.robot->ruri);
  received_at_.Time(record.received_at);
  place_.Int4(place);
  fleet_.Text(record.robot->fleet);
  session_.Uuid(record.session);
  seq_.Int8(record.seq);
}

void ReportColumns::MoveInto(Parameters& parameters) {
  for (Array* column : {&ruri_, &received_at_, &place_, &fleet_, &session_, &seq_}) {
    parameters.Add(std::move(*column));
  }
}

void FaultHistoryRows::Add(const CommitRecord& record, const model::Fault& fault,
                           std::int32_t place) {
  common_.Add(record, place);
  sampled_ms_.Int8(fault.unix_time_ms);
  fault_id_.Text(fault.fault_id);
  source_.Text(fault.source);
  severity_.Int4(NumberOf(fault.severity));
  active_.Bool(fault.active);
  category_.Text(fault.category);
  description_.Text(fault.description);
  suggested_action_.Text(fault.suggested_action);
}

void FaultHistoryRows::MoveInto(std::vector<Call>& calls) {
  Emit(kInsertFaults, common_, calls, sampled_ms_, fault_id_, source_, severity_, active_,
       category_, description_, suggested_action_);
}

void EventRows::Add(const CommitRecord& record, const model::EventTelemetry& event,
                    std::int32_t place) {
  common_.Add(record, place);
  sampled_ms_.Int8(event.unix_time_ms);
  kind_.Text(model::EventKindText(event.kind));
  detail_.Text(json::DetailText(event.kind));
}

void EventRows::MoveInto(std::vector<Call>& calls) {
  Emit(kInsertEvents, common_, calls, sampled_ms_, kind_, detail_);
}

void MessageRows::Add(const CommitRecord& record, const model::Message& message,
                      std::int32_t place) {
  common_.Add(record, place);
  sampled_ms_.Int8(message.unix_time_ms);
  level_.Int4(NumberOf(message.level));
  message_.Text(message.message);
}

void MessageRows::MoveInto(std::vector<Call>& calls) {
  Emit(kInsertMessages, common_, calls, sampled_ms_, level_, message_);
}

void MissionReportRows::Add(const CommitRecord& record, const model::MissionRunStatus& report,
                            std::string_view report_json, std::int32_t place) {
  common_.Add(record, place);
  mission_id_.Text(report.mission_id);
  run_id_.Text(report.run_id);
  status_.Int4(NumberOf(report.status));
  report_.Text(report_json);
}

void MissionReportRows::MoveInto(std::vector<Call>& calls) {
  Emit(kInsertReports, common_, calls, mission_id_, run_id_, status_, report_);
}

void QuarantineRows::Add(const CommitRecord& record, const model::Rejection& rejection,
                         QuarantineDetail detail, std::int32_t place) {
  const bool is_bare = detail == QuarantineDetail::kBare;
  common_.Add(record, place);
  reason_.Int4(static_cast<std::int32_t>(rejection.reason));
  field_.Text(is_bare ? std::string_view() : rejection.field);
  detail_.Text(is_bare ? std::string_view() : rejection.detail);
  payload_bytes_.Int8(record.payload_bytes);
  if (detail == QuarantineDetail::kAll && !record.payload.empty()) {
    payload_.Bytes(record.payload);
  } else {
    payload_.Null();
  }
}

void QuarantineRows::MoveInto(std::vector<Call>& calls) {
  Emit(kInsertQuarantine, common_, calls, reason_, field_, detail_, payload_bytes_, payload_);
}

}  // namespace uplink::storage::postgres
