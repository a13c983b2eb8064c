#include "storage/sqlite/robot_connections.h"

#include <cstdint>

#include "storage/bounds.h"
#include "storage/connection.h"

namespace uplink::storage::sqlite {

absl::Status RobotConnections::Prepare(Database& database) {
  Preparer prepare(database);
  // By no clock: one that was ahead would keep its rows before all that begin later.
  prepare.Into(trim_,
               "DELETE FROM connections WHERE rowid IN (SELECT rowid FROM connections"
               " WHERE ruri = ? ORDER BY is_open DESC, entry DESC LIMIT -1 OFFSET ?)");
  // From process to process by the index: not all of their rows are read.
  prepare.Into(processes_,
               "WITH RECURSIVE p (process) AS (SELECT min(process) FROM connections WHERE is_open"
               " UNION ALL SELECT (SELECT min(c.process) FROM connections AS c"
               " WHERE c.is_open AND c.process > p.process) FROM p WHERE p.process IS NOT NULL)"
               " SELECT process FROM p WHERE process IS NOT NULL AND process <> ?1 LIMIT ?2");
  prepare.Into(end_,
               "UPDATE connections SET is_open = 0, ended_at = max(began_at, ?2), ended_why = ?3,"
               " ended_code = '', ended_detail = ?4 WHERE rowid IN (SELECT rowid FROM connections"
               " WHERE process = ?1 AND is_open LIMIT ?5) RETURNING 1");
  return prepare.status();
}

absl::Status RobotConnections::Trim(std::string_view ruri) {
  return trim_->Run(ruri, kConnectionsPerRobotMax);
}

absl::StatusOr<std::vector<ProcessId>> RobotConnections::Processes(const ProcessId& self) {
  return processes_->Select(self, kOpenProcessesMax).All([](const Rows& row) {
    return row.Uuid(0).bytes();
  });
}

absl::StatusOr<std::size_t> RobotConnections::End(const ProcessId& process, SystemTime now) {
  return end_
      ->Select(process, now, static_cast<std::int64_t>(model::ConnectionEnd::kServerEnded),
               kServerEndedDetail, kSweepRowsMax)
      .Count();
}

}  // namespace uplink::storage::sqlite
