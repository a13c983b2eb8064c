#include "storage/postgres/write/retain.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/postgres/tables/lists.h"
#include "storage/postgres/write/transaction.h"
#include "storage/retention.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "keep the histories";
constexpr std::string_view kNow = "SELECT clock_timestamp()";
constexpr std::string_view kMakePartitions =
    "SELECT uplinkd.make_partitions(($1::timestamptz AT TIME ZONE 'UTC')::date, $2::int)";
/// Partitions that one call of drop_partitions drops at most: each is locked until its end.
constexpr std::size_t kPartitionsPerCallMax = 10;
constexpr std::string_view kDropPartitions =
    "SELECT uplinkd.drop_partitions($1::text, ($2::timestamptz AT TIME ZONE 'UTC')::date)";

/// Deletes the oldest rows of a table, or of its default partition.
template <typename Table>
constexpr SqlText EraseSql(const Table& table, std::string_view partition) {
  const std::string_view time = table.listed.time_column;
  const std::string_view erase_if = table.listed.erase_if;
  SqlText sql = {"DELETE FROM uplinkd.",
                 table.name,
                 partition,
                 " WHERE ctid = ANY (ARRAY(SELECT ctid FROM uplinkd.",
                 table.name,
                 partition,
                 " WHERE ",
                 time,
                 " < $1::timestamptz"};
  if (!erase_if.empty()) sql.Add({" AND ", erase_if});
  sql.Add({" ORDER BY ", time, ", entry LIMIT $2::bigint))"});
  // Once more: a report that another shard commits meanwhile makes a row young again.
  if (!erase_if.empty()) sql.Add({" AND ", erase_if});
  return sql;
}

/// The same of quarantine's default partition. As drop_partitions, it keeps the Rejects that a
/// Hello may still ask for.
constexpr std::string_view kEraseQuarantine =
    "WITH went AS (DELETE FROM uplinkd.quarantine_default WHERE ctid = ANY (ARRAY("
    "SELECT ctid FROM uplinkd.quarantine_default WHERE received_at < $1::timestamptz"
    " ORDER BY received_at, entry LIMIT $2::bigint))"
    " RETURNING ruri, session, seq, entry, source, reason, field, detail),"
    " kept AS (INSERT INTO uplinkd.kept_rejects"
    " (ruri, session, last, first, entry, reason, field, detail)"
    " SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail FROM went AS q"
    " CROSS JOIN LATERAL (SELECT l.first_entry, l.settled_seq FROM uplinkd.sessions AS l"
    " WHERE l.ruri = q.ruri AND l.session = q.session ORDER BY l.part DESC LIMIT 1) AS s"
    " WHERE q.source = 0 AND q.entry >= s.first_entry AND q.seq > s.settled_seq"
    " ON CONFLICT DO NOTHING)"
    " SELECT count(*) FROM went";

/// What says how much a statement did: the rows that it wrote, or its answer.
enum class Counts : std::uint8_t { kRows, kAnswer };

/// One transaction of one statement.
absl::StatusOr<std::size_t> RunAlone(Connection& connection, StoreCall call, Counts counts) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  calls.push_back(std::move(call));
  const auto results = RunAndCommitFor(connection, std::move(calls), kDoing, nullptr);
  if (!results.ok()) return Decisive(results.status());
  const Result& result = (*results)[1];
  return counts == Counts::kRows ? result.written() : static_cast<std::size_t>(result.Int(0, 0));
}

class Eraser final {
 public:
  Eraser(Connection& connection, SystemTime until) : connection_(connection), until_(until) {}

  /// The list's table. Those to which rows are only added are partitioned by the day of arrival.
  template <PageKind kList>
  absl::Status EraseList() {
    static constexpr const auto& kTable = ListTable<kList>::kTable;
    static constexpr bool kPartitioned = kTable.writes == Writes::kInserts;
    static constexpr SqlText kSql = EraseSql(kTable, kPartitioned ? "_default" : "");
    if constexpr (kPartitioned) {
      absl::Status dropped = Drop(kTable.name);
      if (!dropped.ok()) return dropped;
    }
    // Of a partitioned table: what came outside the partitions of days.
    if constexpr (kList == PageKind::kQuarantine) {
      return Erase(kEraseQuarantine, Counts::kAnswer);
    } else {
      return Erase(kSql.view(), Counts::kRows);
    }
  }
  [[nodiscard]] std::size_t erased() const { return erased_; }

 private:
  absl::Status Drop(std::string_view history) {
    std::size_t dropped = kPartitionsPerCallMax;
    while (dropped == kPartitionsPerCallMax) {
      StoreCall call{kDropPartitions, {}};
      call.parameters.Text(history);
      call.parameters.Time(until_);
      const auto some = RunAlone(connection_, std::move(call), Counts::kAnswer);
      if (!some.ok()) return some.status();
      dropped = *some;
      erased_ += dropped;
    }
    return absl::OkStatus();
  }
  absl::Status Erase(std::string_view sql, Counts counts) {
    StoreCall call{sql, {}};
    call.parameters.Time(until_);
    call.parameters.Int8(static_cast<std::int64_t>(kRetainRowsMax));
    return Count(RunAlone(connection_, std::move(call), counts));
  }
  absl::Status Count(const absl::StatusOr<std::size_t>& rows) {
    if (rows.ok()) erased_ += *rows;
    return rows.status();
  }

  Connection& connection_;
  const SystemTime until_;
  std::size_t erased_ = 0;
};

template <Retained kRetained>
absl::StatusOr<std::size_t> EraseLists(Connection& connection, SystemTime until) {
  Eraser eraser(connection, until);
  absl::Status status;
  ForEachList([&eraser, &status]<PageKind kList>() {
    if constexpr (RetainedOf(kList) == kRetained) {
      if (status.ok()) status = eraser.EraseList<kList>();
    }
  });
  if (!status.ok()) return status;
  return eraser.erased();
}

/// A day a transaction, so that none holds its locks for long; today first.
absl::Status MakePartitions(Connection& connection, SystemTime now) {
  std::vector<int> days = {0};
  for (int day = 1; day <= kPartitionDaysAfter; ++day) days.push_back(day);
  for (int day = 1; day <= kPartitionDaysBefore; ++day) days.push_back(-day);
  for (const int day : days) {
    StoreCall call{kMakePartitions, {}};
    call.parameters.Time(now + std::chrono::days(day));
    call.parameters.Int4(1);
    const auto made = RunAlone(connection, std::move(call), Counts::kAnswer);
    if (!made.ok()) return made.status();
  }
  return absl::OkStatus();
}

/// The database's own clock.
absl::StatusOr<SystemTime> DatabaseTime(Connection& connection) {
  std::vector<StoreCall> calls;
  calls.push_back({kNow, {}});
  const auto answer = connection.Run(calls, kDoing);
  if (!answer.ok()) return answer.status();
  return answer->front().Time(0, 0);
}

absl::StatusOr<std::size_t> EraseAll(Connection& connection, SystemTime now,
                                     const StoreRules& rules) {
  std::size_t erased = 0;
  if (const auto kept = FirstDayKept(now, rules.retain_history)) {
    const auto history = EraseLists<Retained::kAsHistory>(connection, *kept);
    if (!history.ok()) return history.status();
    erased += *history;
  }
  if (const auto kept = FirstDayKept(now, rules.retain_quarantine)) {
    const auto set_aside = EraseLists<Retained::kAsSetAside>(connection, *kept);
    if (!set_aside.ok()) return set_aside.status();
    erased += *set_aside;
  }
  return erased;
}

/// A lock that was not free in time is retention's own trouble: the server is there.
absl::Status Told(const Connection& connection, const absl::Status& status) {
  if (!absl::IsUnavailable(status) || connection.broken()) return status;
  return absl::AbortedError(status.message());
}

}  // namespace

absl::StatusOr<std::size_t> RetainRows(Connection& connection, SystemTime now,
                                       const StoreRules& rules) {
  if (!Vouches(rules.clock, now)) {
    const absl::StatusOr<SystemTime> today = DatabaseTime(connection);
    if (!today.ok()) return Told(connection, today.status());
    const absl::Status made = MakePartitions(connection, *today);
    if (!made.ok()) return Told(connection, made);
    return 0;
  }
  const absl::Status made = MakePartitions(connection, now);
  if (connection.broken()) return made;
  // What cannot be made keeps nothing from being dropped.
  auto erased = EraseAll(connection, now, rules);
  if (!erased.ok()) return Told(connection, erased.status());
  if (!made.ok()) return Told(connection, made);
  return erased;
}

}  // namespace uplink::storage::postgres
