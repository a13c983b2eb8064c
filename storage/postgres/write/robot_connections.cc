#include "storage/postgres/write/robot_connections.h"

#include <utility>

#include "storage/bounds.h"
#include "storage/postgres/tables/insert.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

// The lock conflicts with a deletion of the robot's row alone: who forgets the robot waits for us,
// and then finds these rows, or we wait and then find no robot. $1 are the robots of the rows.
constexpr std::string_view kWithRobots =
    "WITH known AS MATERIALIZED (SELECT r.ruri FROM uplinkd.robots AS r"
    " WHERE r.ruri = ANY($1::text[]) ORDER BY r.ruri FOR KEY SHARE) ";
constexpr std::string_view kOfRobots = " WHERE u.ruri IN (SELECT k.ruri FROM known AS k)";
constexpr SqlText kWrite = InsertSql(kConnectionsTable, kWithRobots, kOfRobots);

// By no clock: one that was ahead would keep its rows before all that begin later. A row that
// another server opens or ends meanwhile is left to the next trim.
constexpr std::string_view kTrim =
    "DELETE FROM uplinkd.connections AS c USING unnest($1::text[]) AS u (ruri) CROSS JOIN LATERAL"
    " (SELECT p.id, p.is_open FROM uplinkd.connections AS p WHERE p.ruri = u.ruri"
    " ORDER BY p.is_open DESC, p.entry DESC OFFSET $2::bigint) AS old"
    " WHERE c.ruri = u.ruri AND c.id = old.id AND c.is_open = old.is_open";

// From process to process by the index: not all of their rows are read.
constexpr std::string_view kProcesses =
    "WITH RECURSIVE p AS ((SELECT c.process FROM uplinkd.connections AS c WHERE c.is_open"
    " ORDER BY c.process LIMIT 1) UNION ALL SELECT (SELECT c.process FROM uplinkd.connections AS c"
    " WHERE c.is_open AND c.process > p.process ORDER BY c.process LIMIT 1)"
    " FROM p WHERE p.process IS NOT NULL)"
    " SELECT process FROM p WHERE process IS NOT NULL AND process <> $1::uuid LIMIT $2::bigint";

// What the process tells meanwhile is passed over.
constexpr SqlText kEnd = {
    "UPDATE uplinkd.connections AS c SET is_open = false, ended_at = greatest(c.began_at,"
    " coalesce((SELECT p.renewed_at FROM uplinkd.processes AS p WHERE p.process = $1::uuid),"
    " $2::timestamptz)), ended_why = $3::int, ended_code = '', ended_detail = '",
    kServerEndedDetail,
    "' FROM (SELECT o.ruri, o.id FROM uplinkd.connections AS o"
    " WHERE o.is_open AND o.process = $1::uuid LIMIT $4::bigint FOR UPDATE SKIP LOCKED) AS old"
    " WHERE c.ruri = old.ruri AND c.id = old.id"};

}  // namespace

void ConnectionRows::Add(const ConnectionItem& item, std::int32_t place) {
  const auto [row, is_new] =
      rows_.try_emplace({item.robot->ruri, item.id}, NotedConnection{&item, place});
  if (!is_new && Replaces(item, *row->second.item)) row->second.item = &item;
}

void ConnectionRows::MoveInto(std::vector<StoreCall>& calls) const {
  if (rows_.empty()) return;
  calls.push_back(CallWithRows<kConnectionsTable>(kWrite.view(), rows_));
  Array robots{Type::kText};
  std::string_view last;
  for (const auto& [key, row] : rows_) {
    if (std::exchange(last, key.first) != key.first) robots.Text(key.first);
  }
  calls.push_back(StoreCallOf(kTrim, &robots, kConnectionsPerRobotMax));
}

absl::StatusOr<std::vector<ProcessId>> ProcessesWithOpenConnections(Connection& connection,
                                                                    const ProcessId& self) {
  const auto rows = RunAlone(connection, StoreCallOf(kProcesses, self, kOpenProcessesMax),
                             "look for connections without an end");
  if (!rows.ok()) return rows.status();
  return rows->All([](const ResultRow& row) { return row.Uuid(0).bytes(); });
}

absl::StatusOr<std::size_t> EndConnections(Connection& connection, const ProcessId& process,
                                           SystemTime now,
                                           const std::function<absl::Status()>& before_commit) {
  const auto why = static_cast<std::int32_t>(model::ConnectionEnd::kServerEnded);
  const auto results = RunAndCommitFor(
      connection,
      PipelineOf(StoreCallOf(kBegin), StoreCallOf(kEnd.view(), process, now, why, kSweepRowsMax)),
      "end connections", before_commit);
  if (!results.ok()) return Decisive(results.status());
  return (*results)[1].written();
}

}  // namespace uplink::storage::postgres
