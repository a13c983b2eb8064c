#include "storage/postgres/robot_removal.h"

#include <string>
#include <utility>

#include "storage/kept_tables.h"
#include "storage/leases.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/write/transaction.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kHold = "SELECT owner, epoch FROM uplinkd.robots WHERE ruri = $1::text";
// A lease that was silent for as long as its row is kept is over for every server.
constexpr std::string_view kSilent =
    "SELECT r.ruri, r.epoch FROM uplinkd.robots AS r"
    " LEFT JOIN uplinkd.live AS l ON l.ruri = r.ruri"
    " LEFT JOIN uplinkd.presence_latest AS p ON p.ruri = r.ruri"
    " LEFT JOIN uplinkd.processes AS o ON o.process = r.owner"
    " WHERE r.last_seen < $1::timestamptz"
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
constexpr std::string_view kAsk =
    "INSERT INTO uplinkd.forget_requests (ruri, end_stream) VALUES ($1::text, $2::int <> 0)"
    " RETURNING number";
constexpr std::string_view kDropOldRequests =
    "DELETE FROM uplinkd.forget_requests WHERE touched_at < now() - make_interval(hours => "
    "$1::int)";
constexpr std::string_view kAnswerTo =
    "SELECT answer, epoch FROM uplinkd.forget_requests WHERE number = $1::bigint";
constexpr std::string_view kFinish =
    "UPDATE uplinkd.forget_requests SET finished = true, touched_at = now()"
    " WHERE number = $1::bigint";
constexpr std::string_view kPending =
    "SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch"
    " FROM uplinkd.forget_requests AS f LEFT JOIN uplinkd.robots AS r ON r.ruri = f.ruri"
    " WHERE CASE WHEN f.finished THEN f.touched_at > now() - make_interval(hours => $1::int)"
    " ELSE f.answer = 0 AND f.touched_at > now() - make_interval(mins => $2::int) END"
    " ORDER BY f.number DESC LIMIT $3::bigint";
constexpr std::string_view kAnswer =
    "UPDATE uplinkd.forget_requests SET answer = $2::int, epoch = $3::bigint"
    " WHERE number = $1::bigint AND answer = 0 AND NOT finished";

constexpr std::int32_t kHoursTold = static_cast<std::int32_t>(kForgottenTold.count());

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

struct Statements {
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

}  // namespace

struct PostgresRobotRemoval::Impl {
  Link link;
  const Statements statements;
  /// Entries of the robot that was removed last are below it.
  std::int64_t first_entry_after = 0;

  /// The answers to statements of one transaction, durable on the server that gave them.
  absl::StatusOr<std::vector<Result>> Write(std::vector<StoreCall> work, std::string_view doing) {
    const absl::StatusOr<Connection*> connection = link.Get();
    if (!connection.ok()) return connection.status();
    std::vector<StoreCall> calls = BeginCalls();
    const auto before = static_cast<std::ptrdiff_t>(calls.size());
    for (StoreCall& call : work) calls.push_back(std::move(call));
    auto results = RunAndCommitFor(**connection, std::move(calls), doing, {});
    if (!results.ok()) return results.status();
    results->erase(results->begin(), results->begin() + before);
    return results;
  }
  absl::StatusOr<std::vector<Result>> Read(const std::vector<StoreCall>& calls,
                                           std::string_view doing) {
    const absl::StatusOr<Connection*> connection = link.Get();
    if (!connection.ok()) return connection.status();
    return (*connection)->Run(calls, doing);
  }
};

PostgresRobotRemoval::PostgresRobotRemoval(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresRobotRemoval::~PostgresRobotRemoval() = default;

absl::StatusOr<std::unique_ptr<PostgresRobotRemoval>> PostgresRobotRemoval::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  return std::unique_ptr<PostgresRobotRemoval>(
      new PostgresRobotRemoval(std::make_unique<Impl>(Impl{Link(*std::move(link), clock), {}})));
}

absl::StatusOr<std::optional<RobotHold>> PostgresRobotRemoval::HoldOf(std::string_view ruri) {
  std::vector<StoreCall> calls;
  calls.push_back(CallOf(kHold, ruri));
  const auto answers = impl_->Read(calls, "read who holds a robot");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  if (rows.rows() == 0) return std::nullopt;
  return RobotHold{rows.Uuid(0, 0).bytes(), static_cast<Epoch>(rows.Int(0, 1))};
}

absl::StatusOr<std::vector<TableCount>> PostgresRobotRemoval::Count(std::string_view ruri) {
  std::vector<StoreCall> calls;
  for (const std::string& sql : impl_->statements.count) calls.push_back(CallOf(sql, ruri));
  const auto answers = impl_->Read(calls, "count a robot's rows");
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
  const auto answers = impl_->Read(calls, "look for robots that are silent");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  std::vector<SilentRobot> robots;
  for (int row = 0; row < rows.rows(); ++row) {
    robots.push_back({std::string(rows.Bytes(row, 0)), static_cast<Epoch>(rows.Int(row, 1))});
  }
  return robots;
}

absl::StatusOr<bool> PostgresRobotRemoval::Remove(std::string_view ruri, Epoch epoch) {
  std::vector<StoreCall> calls;
  if (epoch == 0) calls.push_back(CallOf(kStandIn, ruri));
  const std::size_t row = calls.size();
  calls.push_back(CallOf(kRemoveRow, ruri));
  calls.back().parameters.Int8(static_cast<std::int64_t>(epoch));
  calls.push_back({kFirstEntryAfter, {}});
  for (const std::string& sql : impl_->statements.remove) calls.push_back(CallOf(sql, ruri));
  const auto answers = impl_->Write(std::move(calls), "forget a robot");
  if (!answers.ok()) return answers.status();
  if ((*answers)[row].rows() == 0) return false;
  impl_->first_entry_after = (*answers)[row + 1].Int(0, 0);
  return true;
}

absl::StatusOr<std::size_t> PostgresRobotRemoval::RemoveHistories(std::string_view ruri) {
  std::vector<StoreCall> calls;
  for (const std::string& sql : impl_->statements.remove_history) {
    calls.push_back(CallOf(sql, ruri));
    calls.back().parameters.Int8(impl_->first_entry_after);
    calls.back().parameters.Int8(static_cast<std::int64_t>(kRemovedPerCallMax));
  }
  const auto answers = impl_->Write(std::move(calls), "forget a robot's histories");
  if (!answers.ok()) return answers.status();
  std::size_t removed = 0;
  for (std::size_t i = 0; i < kHistoryTables.size(); ++i) removed += (*answers)[i].written();
  return removed;
}

absl::StatusOr<std::uint64_t> PostgresRobotRemoval::Ask(std::string_view ruri, bool end_stream) {
  std::vector<StoreCall> calls;
  calls.push_back({kDropOldRequests, {}});
  calls.back().parameters.Int4(kHoursTold);
  calls.push_back(CallOf(kAsk, ruri));
  calls.back().parameters.Int4(end_stream ? 1 : 0);
  const auto answers = impl_->Write(std::move(calls), "ask for a robot to be forgotten");
  if (!answers.ok()) return answers.status();
  return static_cast<std::uint64_t>((*answers)[1].Int(0, 0));
}

absl::StatusOr<AnsweredForget> PostgresRobotRemoval::AnswerTo(std::uint64_t number) {
  std::vector<StoreCall> calls;
  calls.push_back({kAnswerTo, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  const auto answers = impl_->Read(calls, "read an answer");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  if (rows.rows() == 0) return AnsweredForget();
  return AnsweredForget{static_cast<ForgetAnswer>(rows.Int(0, 0)),
                        static_cast<Epoch>(rows.Int(0, 1))};
}

absl::Status PostgresRobotRemoval::Finish(std::uint64_t number) {
  std::vector<StoreCall> calls;
  calls.push_back({kFinish, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  return impl_->Write(std::move(calls), "tell that a robot is forgotten").status();
}

absl::StatusOr<std::vector<PendingForget>> PostgresRobotRemoval::Pending() {
  std::vector<StoreCall> calls;
  calls.push_back({kPending, {}});
  calls.back().parameters.Int4(kHoursTold);
  calls.back().parameters.Int4(static_cast<std::int32_t>(kForgetRequestLives.count()));
  calls.back().parameters.Int8(static_cast<std::int64_t>(kForgetRequestsMax));
  const auto answers = impl_->Read(calls, "look for robots to be forgotten");
  if (!answers.ok()) return answers.status();
  const Result& rows = answers->front();
  std::vector<PendingForget> pending;
  for (int row = 0; row < rows.rows(); ++row) {
    PendingForget& one = pending.emplace_back();
    one.number = static_cast<std::uint64_t>(rows.Int(row, 0));
    one.ruri = std::string(rows.Bytes(row, 1));
    one.end_stream = rows.Bool(row, 2);
    one.finished = rows.Bool(row, 3);
    if (rows.Null(row, 4)) continue;
    one.hold = RobotHold{rows.Uuid(row, 4).bytes(), static_cast<Epoch>(rows.Int(row, 5))};
  }
  return pending;
}

absl::Status PostgresRobotRemoval::Answer(std::uint64_t number, const AnsweredForget& answer) {
  std::vector<StoreCall> calls;
  calls.push_back({kAnswer, {}});
  calls.back().parameters.Int8(static_cast<std::int64_t>(number));
  calls.back().parameters.Int4(static_cast<std::int32_t>(answer.answer));
  calls.back().parameters.Int8(static_cast<std::int64_t>(answer.epoch));
  return impl_->Write(std::move(calls), "answer whether a robot may be forgotten").status();
}

}  // namespace uplink::storage::postgres
