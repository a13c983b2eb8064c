#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace uplink::storage {

/// A table to which reports are only added, and the column of PostgreSQL's by which it is ordered.
struct HistoryTable {
  std::string_view name;
  std::string_view time_column;
};

/// Tables of both stores, by `ruri`, of what a robot is and has now. They go with it at once. Not
/// among them: robot_settings, whose rows outlive their robots (RobotRemoval).
inline constexpr auto kRobotTables = std::to_array<std::string_view>(
    {"robots", "sessions", "faults_active", "mission_runs", "shapes", "objects", "latest",
     "presence_latest", "gaps", "live", "quarantine_dropped", "kept_rejects", "drone_claims",
     "samples", "operator_requests", "connections"});

/// Those of what a robot reported: rows with a `ruri` and an `entry`.
inline constexpr auto kHistoryTables =
    std::to_array<HistoryTable>({{"faults_history", "received_at"},
                                 {"events", "received_at"},
                                 {"messages", "received_at"},
                                 {"scope_updates", "received_at"},
                                 {"mission_reports", "received_at"},
                                 {"presence_changes", "changed_at"},
                                 {"quarantine", "received_at"}});

/// All of them: something that goes by civil time deletes their rows (age, expiry, or a robot that
/// is forgotten). Where all of them are empty there is nothing to lose.
inline constexpr auto kKeptTables = [] {
  std::array<std::string_view, kRobotTables.size() + kHistoryTables.size()> tables;
  std::size_t next = 0;
  for (const std::string_view table : kRobotTables) tables[next++] = table;
  for (const HistoryTable& table : kHistoryTables) tables[next++] = table.name;
  return tables;
}();

}  // namespace uplink::storage
