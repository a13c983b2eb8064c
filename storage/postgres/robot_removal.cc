#include "storage/postgres/robot_removal.h"

#include <string>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/leases.h"
#include "storage/postgres/own_connection.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kHold = "SELECT owner, epoch FROM uplinkd.robots WHERE ruri = $1::text";
// A lease that was silent for as long as its row is kept is over for every server.
constexpr std::string_view kSilent =
    "SELECT r.ruri, r.epoch FROM uplinkd.robots AS r"
    " LEFT JOIN uplinkd.live AS l ON l.ruri = r.ruri"
    " LEFT JOIN uplinkd.presence_latest AS p ON p.ruri = r.ruri"
    " LEFT JOIN uplinkd.processes AS o ON o.process = r.owner"
    // Those that stand for no robot (origin.h) are left out.
    " WHERE r.last_seen < $1::timestamptz AND left(r.ruri, 10) <> 'cyberwave:'"
    " AND coalesce(l.written_at < $1::timestamptz, true)"
    " AND coalesce(p.changed_at < $1::timestamptz, true)"
    " AND NOT EXISTS (SELECT 1 FROM uplinkd.sessions AS s WHERE s.ruri = r.ruri"
    " AND s.last_used >= $1::timestamptz)"
    " AND (r.owner = $2::uuid OR o.process IS NULL OR o.released"
    " OR o.renewed_at < now() - make_interval(hours => $3::int))"
    " AND r.ruri > $5::text ORDER BY r.ruri LIMIT $4::bigint";
// Stands in for a row that is missing: whoever opens a stream meanwhile waits for the commit.
constexpr std::string_view kStandIn =
    "INSERT INTO uplinkd.robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
    " VALUES ($1::text, '', 0, 0, '00000000-0000-0000-0000-000000000000', now(), now())"
    " ON CONFLICT (ruri) DO NOTHING";
// Waits for the commit of a batch that has the row locked; none begins after it.
constexpr std::string_view kRemoveRow =
    "DELETE FROM uplinkd.robots WHERE ruri = $1::text AND epoch = $2::bigint RETURNING epoch";
constexpr std::string_view kFirstEntryAfter = "SELECT nextval('uplinkd.batches') << 20";
StoreCall CallOf(std::string_view sql, std::string_view ruri) {
  StoreCall call{sql, {}};
  call.parameters.Text(ruri);
  return call;
}

std::string CountSql(std::string_view table) {
  return "SELECT count(*) FROM uplinkd." + std::string(table) + " WHERE ruri = $1::text";
}

/// Once the robot's row is gone: it is there if that was another's.
std::string RemoveSql(std::string_view table) {
  return "DELETE FROM uplinkd." + std::string(table) +
         " WHERE ruri = $1::text"
         " AND NOT EXISTS (SELECT 1 FROM uplinkd.robots AS r WHERE r.ruri = $1::text)";
}

/// By its index on robot and time: no more of it is read than goes.
std::string RemoveHistorySql(const HistoryTable& table) {
  const std::string name = "uplinkd." + std::string(table.name);
  const std::string time(table.time_column);
  return "DELETE FROM " + name + " WHERE ruri = $1::text AND entry < $2::bigint AND " + time +
         " <= (SELECT max(t." + time + ") FROM (SELECT " + time + " FROM " + name +
         " WHERE ruri = $1::text AND entry < $2::bigint ORDER BY " + time +
         " LIMIT $3::bigint) AS t)";
}

}  // namespace

struct PostgresRobotRemoval::Statements {
  std::vector<std::string> count, remove, remove_history;

  Statements() {
    for (const std::string_view table : kKeptTables) count.push_back(CountSql(table));
    for (const std::string_view table : kRobotTables) {
      if (table != "robots") remove.push_back(RemoveSql(table));
    }
    for (const HistoryTable& table : kHistoryTables) {
      remove_history.push_back(RemoveHistorySql(table));
    }
  }
};

PostgresRobotRemoval::PostgresRobotRemoval(OwnConnection& connection)
    : connection_(connection), statements_(std::make_unique<Statements>()) {}
PostgresRobotRemoval::~PostgresRobotRemoval() = default;

absl::StatusOr<std::optional<RobotHold>> PostgresRobotRemoval::HoldOf(std::string_view ruri) {
  std::vector<StoreCall> calls;
  calls.push_back(CallOf(kHold, ruri));
  const auto answers = connection_.Read(calls, "read who holds a robot");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  if (rows.rows() == 0) return std::nullopt;
  return RobotHold{rows.Uuid(0, 0).bytes(), static_cast<Epoch>(rows.Int(0, 1))};
}

absl::StatusOr<std::vector<TableCount>> PostgresRobotRemoval::Count(std::string_view ruri) {
  std::vector<StoreCall> calls;
  for (const std::string& sql : statements_->count) calls.push_back(CallOf(sql, ruri));
  const auto answers = connection_.Read(calls, "count a robot's rows");
  if (!answers.ok()) return answers.status();
  std::vector<TableCount> counts;
  for (std::size_t i = 0; i < kKeptTables.size(); ++i) {
    const auto rows = static_cast<std::uint64_t>((*answers)[i].Int(0, 0));
    if (rows > 0) counts.push_back({kKeptTables[i], rows});
  }
  return counts;
}

absl::StatusOr<std::vector<SilentRobot>> PostgresRobotRemoval::SilentSince(SystemTime until,
                                                                           const ProcessId& self,
                                                                           std::string_view after) {
  std::vector<StoreCall> calls;
  calls.push_back({kSilent, {}});
  Parameters& parameters = calls.back().parameters;
  parameters.Time(until);
  parameters.Uuid(model::SessionId(self));
  parameters.Int4(static_cast<std::int32_t>(kLeaseKept.count()));
  parameters.Int8(static_cast<std::int64_t>(kSilentRobotsMax));
  parameters.Text(after);
  const auto answers = connection_.Read(calls, "look for robots that are silent");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  std::vector<SilentRobot> robots;
  robots.reserve(static_cast<std::size_t>(rows.rows()));
  for (int row = 0; row < rows.rows(); ++row) {
    robots.push_back({std::string(rows.Bytes(row, 0)), static_cast<Epoch>(rows.Int(row, 1))});
  }
  return robots;
}

absl::StatusOr<std::optional<EntryBound>> PostgresRobotRemoval::Remove(std::string_view ruri,
                                                                       Epoch epoch) {
  std::vector<StoreCall> calls;
  if (epoch == 0) calls.push_back(CallOf(kStandIn, ruri));
  const std::size_t row = calls.size();
  calls.push_back(CallOf(kRemoveRow, ruri));
  calls.back().parameters.Int8(static_cast<std::int64_t>(epoch));
  calls.push_back({kFirstEntryAfter, {}});
  for (const std::string& sql : statements_->remove) calls.push_back(CallOf(sql, ruri));
  const auto answers = connection_.Write(std::move(calls), "forget a robot");
  if (!answers.ok()) return answers.status();
  if ((*answers)[row].rows() == 0) return std::nullopt;
  return EntryBound{(*answers)[row + 1].Int(0, 0)};
}

absl::StatusOr<std::size_t> PostgresRobotRemoval::RemoveHistories(std::string_view ruri,
                                                                  EntryBound below) {
  std::vector<StoreCall> calls;
  for (const std::string& sql : statements_->remove_history) {
    calls.push_back(CallOf(sql, ruri));
    calls.back().parameters.Int8(static_cast<std::int64_t>(below));
    calls.back().parameters.Int8(static_cast<std::int64_t>(kRemovedPerCallMax));
  }
  const auto answers = connection_.Write(std::move(calls), "forget a robot's histories");
  if (!answers.ok()) return answers.status();
  std::size_t removed = 0;
  for (std::size_t i = 0; i < kHistoryTables.size(); ++i) removed += (*answers)[i].written();
  return removed;
}

}  // namespace uplink::storage::postgres
