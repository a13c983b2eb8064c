#include "storage/forget_store.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/kept_tables.h"
#include "storage/leases.h"
#include "storage/postgres/access_sql.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kAsk =
    "INSERT INTO uplinkd.forget_requests (ruri, end_stream) VALUES ($1::text, $2::int <> 0)"
    " RETURNING number";
constexpr std::string_view kDropOldRequests =
    "DELETE FROM uplinkd.forget_requests WHERE touched_at < now() - make_interval(secs => "
    "$1::int)";
constexpr std::string_view kAnswerTo =
    "SELECT answer, epoch FROM uplinkd.forget_requests WHERE number = $1::bigint";
constexpr std::string_view kFinish =
    "UPDATE uplinkd.forget_requests SET finished = true, touched_at = now(),"
    " answer = CASE WHEN $2::int <> 0 THEN $3::int ELSE answer END"
    " WHERE number = $1::bigint";
constexpr std::string_view kPending =
    "SELECT f.number, f.ruri, f.end_stream, f.finished, r.owner, r.epoch, f.answer"
    " FROM uplinkd.forget_requests AS f LEFT JOIN uplinkd.robots AS r ON r.ruri = f.ruri"
    " WHERE CASE WHEN f.finished THEN f.touched_at > now() - make_interval(secs => $1::int)"
    " ELSE f.answer = 0 AND f.touched_at > now() - make_interval(secs => $2::int) END"
    " ORDER BY f.number DESC LIMIT $3::bigint";
constexpr std::string_view kAnswer =
    "UPDATE uplinkd.forget_requests SET answer = $2::int, epoch = $3::bigint"
    " WHERE number = $1::bigint AND answer = 0 AND NOT finished";

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
    " AND NOT EXISTS (SELECT 1 FROM uplinkd.drone_claims AS c WHERE c.ruri = r.ruri"
    " AND c.last_used >= $1::timestamptz)"
    " AND (r.owner = $2::uuid OR o.process IS NULL OR o.released"
    " OR o.renewed_at < now() - make_interval(hours => $3::int))"
    " AND r.ruri > $5::text ORDER BY r.ruri LIMIT $4::bigint";
// Stands in for a row that is missing: a process that opens a stream meanwhile waits for the
// commit.
constexpr std::string_view kStandIn =
    "INSERT INTO uplinkd.robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
    " VALUES ($1::text, '', 0, 0, '00000000-0000-0000-0000-000000000000', now(), now())"
    " ON CONFLICT (ruri) DO NOTHING";
// Waits for the commit of a batch that has the row locked; none begins after it.
constexpr std::string_view kRemoveRow =
    "DELETE FROM uplinkd.robots WHERE ruri = $1::text AND epoch = $2::bigint RETURNING epoch";
constexpr std::string_view kFirstEntryAfter = "SELECT nextval('uplinkd.batches') << 20";
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

constexpr std::int32_t SecondsOf(std::chrono::seconds time) {
  return static_cast<std::int32_t>(time.count());
}

class PostgresForgetRequests final : public ForgetRequests {
 public:
  /// It must outlive this.
  explicit PostgresForgetRequests(OwnConnection& connection) : connection_(connection) {}

  absl::StatusOr<std::uint64_t> Ask(std::string_view ruri, bool end_stream) override {
    const auto answers =
        connection_.Write(PipelineOf(StoreCallOf(kDropOldRequests, SecondsOf(kForgottenTold)),
                                     StoreCallOf(kAsk, ruri, end_stream ? 1 : 0)),
                          "ask for a robot to be forgotten");
    if (!answers.ok()) return answers.status();
    return static_cast<std::uint64_t>((*answers)[1].Int(0, 0));
  }
  absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) override {
    const auto rows = connection_.Read(StoreCallOf(kAnswerTo, number), "read an answer");
    if (!rows.ok()) return rows.status();
    if (rows->rows() == 0) return AnsweredForget();
    return AnswerIn(*rows->begin());
  }
  absl::Status Finish(std::uint64_t number, bool removed) override {
    return connection_
        .Write(StoreCallOf(kFinish, number, removed ? 1 : 0, kForgetRemoved),
               "tell that a robot is forgotten")
        .status();
  }
  absl::StatusOr<std::vector<PendingForget>> Pending() override {
    const auto rows =
        connection_.Read(StoreCallOf(kPending, SecondsOf(kForgottenTold),
                                     SecondsOf(kForgetRequestLives), kForgetRequestsMax),
                         "look for robots to be forgotten");
    if (!rows.ok()) return rows.status();
    return rows->All(PendingIn<ResultRow>);
  }
  absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) override {
    return connection_
        .Write(StoreCallOf(kAnswer, number, static_cast<std::int32_t>(answer.answer), answer.epoch),
               "answer whether a robot may be forgotten")
        .status();
  }

 private:
  OwnConnection& connection_;
};

class PostgresRobotRemoval final : public RobotRemoval {
 public:
  /// It must outlive this.
  explicit PostgresRobotRemoval(OwnConnection& connection) : connection_(connection) {
    for (const std::string_view table : kKeptTables) counts_.push_back(CountSql(table));
    for (const std::string_view table : kRobotTables) {
      if (table != "robots") removals_.push_back(RemoveSql(table));
    }
    for (const HistoryTable& table : kHistoryTables) {
      history_removals_.push_back(RemoveHistorySql(table));
    }
  }

  absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) override {
    const auto rows = connection_.Read(StoreCallOf(kHold, ruri), "read who holds a robot");
    if (!rows.ok()) return rows.status();
    if (rows->rows() == 0) return std::nullopt;
    return HoldIn(*rows->begin(), 0);
  }
  absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) override {
    std::vector<StoreCall> calls;
    for (const std::string& sql : counts_) calls.push_back(StoreCallOf(sql, ruri));
    const auto answers = connection_.Read(calls, "count a robot's rows");
    if (!answers.ok()) return answers.status();
    std::vector<TableCount> counts;
    for (std::size_t i = 0; i < kKeptTables.size(); ++i) {
      const auto rows = static_cast<std::uint64_t>((*answers)[i].Int(0, 0));
      if (rows > 0) counts.push_back({kKeptTables[i], rows});
    }
    return counts;
  }
  absl::StatusOr<std::vector<SilentRobot>> SilentSince(SystemTime until, const ProcessId& self,
                                                       std::string_view after) override {
    const auto hours = static_cast<std::int32_t>(kLeaseKept.count());
    const auto rows =
        connection_.Read(StoreCallOf(kSilent, until, self, hours, kSilentRobotsMax, after),
                         "look for robots that are silent");
    if (!rows.ok()) return rows.status();
    return rows->All([](const ResultRow& row) {
      return SilentRobot{TextIn(row, 0), NumberIn(row, 1)};
    });
  }
  absl::StatusOr<std::optional<EntryBound>> Remove(std::string_view ruri, Epoch epoch) override {
    std::vector<StoreCall> calls;
    if (epoch == 0) calls.push_back(StoreCallOf(kStandIn, ruri));
    const std::size_t row = calls.size();
    calls.push_back(StoreCallOf(kRemoveRow, ruri, epoch));
    calls.push_back(StoreCallOf(kFirstEntryAfter));
    for (const std::string& sql : removals_) calls.push_back(StoreCallOf(sql, ruri));
    calls.push_back(StoreCallOf(kDropNotesSql.view(), ruri));
    const auto answers = connection_.Write(std::move(calls), "forget a robot");
    if (!answers.ok()) return answers.status();
    if ((*answers)[row].rows() == 0) return std::nullopt;
    return EntryBound{(*answers)[row + 1].Int(0, 0)};
  }
  absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri, EntryBound below) override {
    std::vector<StoreCall> calls;
    for (const std::string& sql : history_removals_) {
      calls.push_back(StoreCallOf(sql, ruri, static_cast<std::int64_t>(below), kRemovedPerCallMax));
    }
    const auto answers = connection_.Write(std::move(calls), "forget a robot's histories");
    if (!answers.ok()) return answers.status();
    std::size_t removed = 0;
    for (std::size_t i = 0; i < history_removals_.size(); ++i) removed += (*answers)[i].written();
    return removed;
  }

 private:
  OwnConnection& connection_;
  std::vector<std::string> counts_, removals_, history_removals_;
};

/// One connection for both.
class PostgresForgetStore final : public ForgetStore {
 public:
  explicit PostgresForgetStore(std::unique_ptr<OwnConnection> connection)
      : connection_(std::move(connection)), removal_(*connection_), requests_(*connection_) {}

  RobotRemoval& removal() override { return removal_; }
  ForgetRequests& requests() override { return requests_; }

 private:
  const std::unique_ptr<OwnConnection> connection_;
  PostgresRobotRemoval removal_;
  PostgresForgetRequests requests_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ForgetStore>> MakeForgetStore(const StoreOptions& options,
                                                             const Clock& clock) {
  return MakeOverOwn<PostgresForgetStore>(options, clock);
}

}  // namespace uplink::storage::postgres
