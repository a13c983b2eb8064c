#pragma once

#include "storage/postgres/tables/reports.h"

// Mission runs as they stand.
namespace uplink::storage::postgres {

/// What a batch reported of one run.
struct MissionRun {
  /// The last report.
  const CommitRecord* record = nullptr;
  const model::MissionRunStatus* body = nullptr;
  std::string_view latest_json;
  /// The last name that a report of the batch gave; nullptr if none did.
  const std::string* name = nullptr;
  /// Of the first report.
  SystemTime first_at;
  std::int32_t place = 0;
  /// Of the last report.
  std::int32_t last_place = 0;
  std::int64_t updates = 0;
};

/// What the column last_entry makes of a place.
inline constexpr std::string_view kLastEntryOfPlace =
    "(SELECT currval('uplinkd.batches') << 20) + last_entry";

/// first_at and entry are those of the run's first report. A report opens a run that the server
/// closed.
inline constexpr Table<MissionRun, MissionRunRow, 15> kMissionRunsTable = {
    "mission_runs",
    Writes::kUpserts,
    {"first_at", [](SystemTime time, MissionRunRow& row) { row.first_received_at = time; },
     "is_open", "last_at < $1::timestamptz AND NOT is_open"},
    Join(kMissionColumns<MissionRun, MissionRunRow>,
         std::to_array<Column<MissionRun, MissionRunRow>>({
             {"ruri", Type::kText, Role::kKey,
              [](Array& to, const MissionRun& row) { to.Text(row.record->robot->ruri); }},
             {"fleet", Type::kText, Role::kValue,
              [](Array& to, const MissionRun& row) { to.Text(row.record->robot->fleet); }},
             {"first_at", Type::kTime, Role::kKept,
              [](Array& to, const MissionRun& row) { to.Time(row.first_at); }},
             {"entry", Type::kInt4, Role::kKept,
              [](Array& to, const MissionRun& row) { to.Int4(row.place); }, std::nullopt,
              kEntryOfPlace},
             {"last_at", Type::kTime, Role::kValue,
              [](Array& to, const MissionRun& row) { to.Time(row.record->received_at); },
              [](const Cell& cell, MissionRunRow& row) { row.last_received_at = cell.Time(); }},
             {"name",
              Type::kText,
              Role::kValue,
              [](Array& to, const MissionRun& row) {
                to.Text(row.name == nullptr ? std::string_view() : *row.name);
              },
              [](const Cell& cell, MissionRunRow& row) { row.name = cell.Text(); },
              {},
              // A report without a name leaves the name that is there. $16, after the columns: 1 if
              // the names count.
              "CASE WHEN $16::int = 1 THEN excluded.name ELSE t.name END"},
             {"is_open", Type::kBool, Role::kValue,
              [](Array& to,
                 const MissionRun& row) { to.Bool(!model::IsTerminal(row.body->status)); }},
             {"updates",
              Type::kInt8,
              Role::kValue,
              [](Array& to, const MissionRun& row) { to.Int8(row.updates); },
              [](const Cell& cell, MissionRunRow& row) {
                row.updates = static_cast<std::uint64_t>(cell.Int());
              },
              {},
              "t.updates + excluded.updates"},
             {"latest", Type::kText, Role::kValue,
              [](Array& to, const MissionRun& row) { to.Text(row.latest_json); },
              [](const Cell& cell, MissionRunRow& row) { row.latest_json = cell.Text(); }},
             {"last_entry", Type::kInt4, Role::kValue,
              [](Array& to, const MissionRun& row) { to.Int4(row.last_place); }, std::nullopt,
              kLastEntryOfPlace},
             {"closed_why", Type::kInt4, Role::kValue,
              [](Array& to, const MissionRun& /*row*/) { to.Int4(0); },
              [](const Cell& cell, MissionRunRow& row) { row.closed = RunClosedOf(cell.Int()); }},
             {"closed_at", Type::kTime, Role::kValue,
              [](Array& to, const MissionRun& /*row*/) { to.Time(SystemTime()); },
              [](const Cell& cell, MissionRunRow& row) { row.closed_at_ms = UnixMs(cell.Time()); }},
         }))};

}  // namespace uplink::storage::postgres
