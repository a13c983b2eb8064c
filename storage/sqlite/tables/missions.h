#pragma once

#include "schema/model/mission.h"
#include "storage/numbers.h"
#include "storage/rows.h"
#include "storage/sqlite/tables/report_columns.h"

// Missions: every report, and each run as it stands.
namespace uplink::storage::sqlite {

struct MissionReport {
  const CommitRecord* record = nullptr;
  const model::MissionRunStatus* body = nullptr;
  /// json::Text of the report; the text outlives the writes.
  std::string_view json;
  EntryNumber entry = 0;
};

/// What names a run of a robot, and how it stands. Out: the row of a report or of a run.
template <typename Out>
inline constexpr std::array<Column<MissionReport, Out>, 3> kMissionColumns = {{
    {"mission_id", Role::kKey,
     [](Binder& to, const MissionReport& row) { to.Text(row.body->mission_id); },
     [](const Cell& cell, Out& row) { row.mission_id = cell.Text(); }},
    {"run_id", Role::kKey, [](Binder& to, const MissionReport& row) { to.Text(row.body->run_id); },
     [](const Cell& cell, Out& row) { row.run_id = cell.Text(); }},
    {"status", Role::kValue,
     [](Binder& to, const MissionReport& row) { to.Int(NumberOf(row.body->status)); },
     [](const Cell& cell, Out& row) { row.status = MemberOf<model::MissionStatus>(cell.Int()); }},
}};

inline constexpr Table<MissionReport, MissionReportRow, 10> kMissionReportsTable = {
    "mission_reports", Writes::kInserts, ByArrival<MissionReportRow>(),
    Join(kReportColumns<MissionReport, MissionReportRow>,
         Join(kMissionColumns<MissionReportRow>,
              std::to_array<Column<MissionReport, MissionReportRow>>({
                  {"report", Role::kValue,
                   [](Binder& to, const MissionReport& row) { to.Text(row.json); },
                   [](const Cell& cell, MissionReportRow& row) { row.report_json = cell.Text(); }},
              })))};

/// first_at and entry are those of the run's first report. A report opens a run that the server
/// closed.
inline constexpr Table<MissionReport, MissionRunRow, 15> kMissionRunsTable = {
    "mission_runs",
    Writes::kUpserts,
    {"first_at", [](SystemTime time, MissionRunRow& row) { row.first_received_at = time; },
     "is_open", "last_at < ?1 AND NOT is_open"},
    Join(
        kMissionColumns<MissionRunRow>,
        std::to_array<Column<MissionReport, MissionRunRow>>({
            {"name", Role::kValue,
             [](Binder& to, const MissionReport& row) {
               if (row.body->name) {
                 to.Text(*row.body->name);
               } else {
                 to.Null();
               }
             },
             [](const Cell& cell, MissionRunRow& row) { row.name = cell.Text(); },
             "coalesce(?, '')",
             // A report without a name leaves the last one that a report gave. ?4: the bound one.
             "coalesce(?4, name)"},
            {"ruri", Role::kKey,
             [](Binder& to, const MissionReport& row) { to.Text(row.record->robot->ruri); }},
            {"fleet", Role::kValue,
             [](Binder& to, const MissionReport& row) { to.Text(row.record->robot->fleet); }},
            {"first_at", Role::kKept,
             [](Binder& to, const MissionReport& row) { to.Time(row.record->received_at); }},
            {"entry", Role::kKept, [](Binder& to, const MissionReport& row) { to.Int(row.entry); }},
            {"last_at", Role::kValue,
             [](Binder& to, const MissionReport& row) { to.Time(row.record->received_at); },
             [](const Cell& cell, MissionRunRow& row) { row.last_received_at = cell.Time(); }},
            {"is_open", Role::kValue,
             [](Binder& to,
                const MissionReport& row) { to.Int(model::IsTerminal(row.body->status) ? 0 : 1); }},
            {"updates",
             Role::kValue,
             [](Binder& to, const MissionReport& /*row*/) { to.Int(1); },
             [](const Cell& cell, MissionRunRow& row) {
               row.updates = static_cast<std::uint64_t>(cell.Int());
             },
             {},
             "updates + excluded.updates"},
            {"latest", Role::kValue,
             [](Binder& to, const MissionReport& row) { to.Text(row.json); },
             [](const Cell& cell, MissionRunRow& row) { row.latest_json = cell.Text(); }},
            {"last_entry", Role::kValue,
             [](Binder& to, const MissionReport& row) { to.Int(row.entry); }},
            {"closed_why", Role::kValue,
             [](Binder& to, const MissionReport& /*row*/) { to.Int(0); },
             [](const Cell& cell, MissionRunRow& row) { row.closed = RunClosedOf(cell.Int()); }},
            {"closed_at", Role::kValue, [](Binder& to, const MissionReport& /*row*/) { to.Int(0); },
             [](const Cell& cell, MissionRunRow& row) { row.closed_at_ms = cell.Int(); }},
        }))};

}  // namespace uplink::storage::sqlite
