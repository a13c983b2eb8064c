#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/model/mission.h"
#include "storage/commit_record.h"
#include "storage/rows.h"
#include "storage/tables/reports.h"
#include "storage/tables/table.h"

// Missions: every report, and each run as it stands.
namespace uplink::storage {

struct MissionReport {
  const CommitRecord* record = nullptr;
  const model::MissionRunStatus* body = nullptr;
  /// json::Text of the report; the text outlives the writes.
  std::string_view json;
  Entry entry;
};

/// What was reported of one run: by one report, or by several of a batch.
struct MissionRun {
  explicit MissionRun(const MissionReport& report) : first(report), last(report) { Name(report); }

  void Add(const MissionReport& report) {
    last = report;
    ++updates;
    Name(report);
  }

  MissionReport first;
  MissionReport last;
  /// The last one that a report gave; nothing if none did.
  std::optional<std::string_view> name;
  std::uint64_t updates = 1;

 private:
  void Name(const MissionReport& report) {
    if (report.body->name) name = *report.body->name;
  }
};

constexpr const model::MissionRunStatus& BodyOf(const MissionRun& run) { return *run.last.body; }

/// What names a run of a robot, and how it stands.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 3> kMissionColumns = {{
    Same("mission_id", [](auto& run) { return &run.mission_id; }).Key(),
    Same("run_id", [](auto& run) { return &run.run_id; }).Key(),
    Same("status", [](auto& run) { return &run.status; }),
}};

inline constexpr Table<MissionReport, MissionReportRow, 10> kMissionReportsTable = {
    "mission_reports", Writes::kInserts, ByArrival<MissionReportRow>(),
    Join(kReportColumns<MissionReport, MissionReportRow>,
         Join(kMissionColumns<MissionReport, MissionReportRow>,
              std::array<Column<MissionReport, MissionReportRow>, 1>{
                  Col<&MissionReportRow::report_json>("report",
                                                      [](const auto& row) { return row.json; })}))};

/// first_at and entry are those of the run's first report. A report opens a run that the server
/// closed.
inline constexpr Table<MissionRun, MissionRunRow, 15> kMissionRunsTable = {
    "mission_runs",
    Writes::kUpserts,
    {"first_at", [](SystemTime time, MissionRunRow& row) { row.first_received_at = time; },
     "is_open", "last_at"},
    Join(kMissionColumns<MissionRun, MissionRunRow>,
         std::array<Column<MissionRun, MissionRunRow>, 12>{
             kRobotRuri.Key(),
             kRobotFleet,
             Col("first_at", [](const auto& run) { return run.first.record->received_at; }).Kept(),
             Col("entry", [](const auto& run) { return run.first.entry; }).Kept(),
             Col<&MissionRunRow::last_received_at>(
                 "last_at", [](const auto& run) { return run.last.record->received_at; }),
             // A report without a name leaves the name that is there.
             Col<&MissionRunRow::name>("name", [](const auto& run) { return run.name; })
                 .Updated("coalesce(excluded.name, t.name)"),
             Col("is_open", [](const auto& run) { return !IsTerminal(run.last.body->status); }),
             Col<&MissionRunRow::updates>("updates", [](const auto& run) { return run.updates; })
                 .Updated("t.updates + excluded.updates"),
             Col<&MissionRunRow::latest_json>("latest",
                                              [](const auto& run) { return run.last.json; }),
             Col("last_entry", [](const auto& run) { return run.last.entry; }),
             Col<&MissionRunRow::closed>("closed_why",
                                         [](const auto& /*run*/) { return RunClosed::kNot; }),
             Col<&MissionRunRow::closed_at_ms>("closed_at",
                                               [](const auto& /*run*/) { return SystemTime(); }),
         })};

}  // namespace uplink::storage
