#pragma once

#include "schema/json/text.h"
#include "schema/model/record.h"
#include "storage/numbers.h"
#include "storage/postgres/tables/report_columns.h"
#include "storage/reader.h"

// What robots report and what is kept as it came: events, messages and mission reports.
namespace uplink::storage::postgres {

using EventReport = Report<model::EventTelemetry>;
using MessageReport = Report<model::Message>;

struct MissionReport {
  const CommitRecord* record = nullptr;
  const model::MissionRunStatus* body = nullptr;
  /// json::Text of the report; the text lives as long as the batch's rows.
  std::string_view json;
  std::int32_t place = 0;
};

inline constexpr Table<EventReport, EventRow, 9> kEventsTable = {
    "events", Writes::kInserts, ByArrival<EventRow>(),
    Join(kReportColumns<EventReport, EventRow>,
         std::to_array<Column<EventReport, EventRow>>({
             {"sampled_ms", Type::kInt8, Role::kValue,
              [](Array& to, const EventReport& row) { to.Int8(row.body->unix_time_ms); },
              [](const Cell& cell, EventRow& row) { row.sampled_at_ms = cell.Int(); }},
             {"kind", Type::kText, Role::kValue,
              [](Array& to, const EventReport& row) {
                to.Text(model::EventKindText(row.body->kind));
              },
              [](const Cell& cell, EventRow& row) { row.kind = cell.Text(); }},
             {"detail", Type::kText, Role::kValue,
              [](Array& to, const EventReport& row) { to.Text(json::DetailText(row.body->kind)); },
              [](const Cell& cell, EventRow& row) { row.detail_json = cell.Text(); }},
         }))};

inline constexpr Table<MessageReport, MessageRow, 10> kMessagesTable = {
    "messages", Writes::kInserts, ByArrival<MessageRow>(),
    Join(kReportColumns<MessageReport, MessageRow>,
         std::to_array<Column<MessageReport, MessageRow>>({
             {"sampled_ms", Type::kInt8, Role::kValue,
              [](Array& to, const MessageReport& row) { to.Int8(row.body->unix_time_ms); },
              [](const Cell& cell, MessageRow& row) { row.message.unix_time_ms = cell.Int(); }},
             {"level", Type::kInt4, Role::kValue,
              [](Array& to, const MessageReport& row) { to.Int4(NumberOf(row.body->level)); },
              [](const Cell& cell, MessageRow& row) {
                row.message.level = MemberOf<model::MessageLevel>(cell.Int());
              }},
             {"message", Type::kText, Role::kValue,
              [](Array& to, const MessageReport& row) { to.Text(row.body->message); },
              [](const Cell& cell, MessageRow& row) { row.message.message = cell.Text(); }},
             {"detail", Type::kText, Role::kValue,
              [](Array& to, const MessageReport& row) { to.Text(row.body->detail_json); },
              [](const Cell& cell, MessageRow& row) { row.message.detail_json = cell.Text(); }},
         }))};

/// What names a run of a robot, and how it stands. In: has `body`. Out: the row of a report or of a
/// run.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 3> kMissionColumns = {{
    {"mission_id", Type::kText, Role::kKey,
     [](Array& to, const In& row) { to.Text(row.body->mission_id); },
     [](const Cell& cell, Out& row) { row.mission_id = cell.Text(); }},
    {"run_id", Type::kText, Role::kKey, [](Array& to, const In& row) { to.Text(row.body->run_id); },
     [](const Cell& cell, Out& row) { row.run_id = cell.Text(); }},
    {"status", Type::kInt4, Role::kValue,
     [](Array& to, const In& row) { to.Int4(NumberOf(row.body->status)); },
     [](const Cell& cell, Out& row) { row.status = MemberOf<model::MissionStatus>(cell.Int()); }},
}};

inline constexpr Table<MissionReport, MissionReportRow, 10> kMissionReportsTable = {
    "mission_reports", Writes::kInserts, ByArrival<MissionReportRow>(),
    Join(kReportColumns<MissionReport, MissionReportRow>,
         Join(kMissionColumns<MissionReport, MissionReportRow>,
              std::to_array<Column<MissionReport, MissionReportRow>>({
                  {"report", Type::kText, Role::kValue,
                   [](Array& to, const MissionReport& row) { to.Text(row.json); },
                   [](const Cell& cell, MissionReportRow& row) { row.report_json = cell.Text(); }},
              })))};

}  // namespace uplink::storage::postgres
