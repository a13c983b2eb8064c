#include "storage/postgres/write/retain.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/lists.h"
#include "storage/postgres/write/transaction.h"
#include "storage/retention.h"
#include "storage/store_rules.h"
#include "storage/tables/lists.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoingQuarantine = "keep the quarantine";
/// Days that one call drops, before the journal's turn ends.
constexpr std::size_t kDaysPerCallMax = 10;
constexpr std::string_view kTake =
    "SELECT day IS NOT NULL, first_at, taken, kept FROM uplinkd.take_quarantine("
    "($1::timestamptz AT TIME ZONE 'UTC')::date, $2::timestamptz, $3::int)";
constexpr std::string_view kDrop =
    "SELECT uplinkd.drop_partitions('quarantine', ($1::timestamptz AT TIME ZONE 'UTC')::date)";
/// What arrived outside the partitions of days. As take_quarantine, it keeps the Rejects that a
/// Hello may still ask for.
constexpr std::string_view kEraseDefault =
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
    " ON CONFLICT DO NOTHING RETURNING 1)"
    " SELECT (SELECT count(*) FROM went), (SELECT count(*) FROM kept)";

std::size_t Count(const Result& result, int column) {
  return static_cast<std::size_t>(result.Int(0, column));
}

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
  SqlText ended;
  if (!table.listed.last_column.empty()) {
    ended.Add({" AND ", table.listed.last_column, " < $1::timestamptz"});
  }
  if (!table.listed.open_column.empty()) ended.Add({" AND NOT ", table.listed.open_column});
  SqlText sql = {
      "DELETE FROM uplinkd.", table.name, partition,
      " WHERE ctid = ANY (ARRAY(SELECT ctid FROM uplinkd.", table.name, partition, " WHERE ", time,
      " < $1::timestamptz", ended.view(), " ORDER BY ", time, ", entry LIMIT $2::bigint))",
      // Once more: a report that another shard commits meanwhile makes a row young again.
      ended.view()};
  return sql;
}

class Eraser final {
 public:
  Eraser(Connection& connection, QuarantineDays& days) : connection_(connection), days_(days) {}

  template <Retained kRetained>
  absl::Status EraseLists(SystemTime until) {
    until_ = until;
    absl::Status status;
    ForEachList([&]<PageKind kList>() {
      if constexpr (RetainedOf(kList) == kRetained) {
        if (status.ok()) status = EraseList<kList>();
      }
    });
    return status;
  }
  absl::Status EraseAudit(SystemTime until) {
    static constexpr SqlText kSql = EraseSql(kAuditTable, "");
    until_ = until;
    return Erase(kSql.view());
  }
  [[nodiscard]] const Erased& erased() const { return erased_; }

 private:
  /// The list's table. Those to which rows are only added are partitioned by the day of arrival.
  template <PageKind kList>
  absl::Status EraseList() {
    static constexpr const auto& kTable = List<kList>::kTable;
    static constexpr bool kPartitioned = kTable.writes == Writes::kInserts;
    static constexpr SqlText kSql = EraseSql(kTable, kPartitioned ? "_default" : "");
    if constexpr (kList == PageKind::kQuarantine) {
      return Add(days_.Erase(connection_, until_));
    } else {
      if constexpr (kPartitioned) {
        absl::Status dropped = Drop(kTable.name);
        if (!dropped.ok()) return dropped;
      }
      // Of a partitioned table: what came outside the partitions of days.
      return Erase(kSql.view());
    }
  }
  absl::Status Drop(std::string_view history) {
    std::size_t dropped = kPartitionsPerCallMax;
    while (dropped == kPartitionsPerCallMax) {
      const auto some =
          RunAlone(connection_, StoreCallOf(kDropPartitions, history, until_), kDoing);
      if (!some.ok()) return some.status();
      dropped = static_cast<std::size_t>(some->Int(0, 0));
      erased_.rows += dropped;
    }
    return absl::OkStatus();
  }
  absl::Status Erase(std::string_view sql) {
    const auto result = RunAlone(connection_, StoreCallOf(sql, until_, kRetainRowsMax), kDoing);
    if (!result.ok()) return result.status();
    return Add(Erased{.rows = result->written(), .more = result->written() == kRetainRowsMax});
  }
  absl::Status Add(const absl::StatusOr<Erased>& some) {
    if (!some.ok()) return some.status();
    erased_.rows += some->rows;
    erased_.rejects_kept += some->rejects_kept;
    erased_.more = erased_.more || some->more;
    return absl::OkStatus();
  }

  Connection& connection_;
  QuarantineDays& days_;
  SystemTime until_;
  Erased erased_;
};

/// A day a transaction, so that none holds its locks for long; today first.
absl::Status MakePartitions(Connection& connection, SystemTime now) {
  std::vector<int> days = {0};
  for (int day = 1; day <= kPartitionDaysAfter; ++day) days.push_back(day);
  for (int day = 1; day <= kPartitionDaysBefore; ++day) days.push_back(-day);
  for (const int day : days) {
    const auto made =
        RunAlone(connection, StoreCallOf(kMakePartitions, now + std::chrono::days(day), 1), kDoing);
    if (!made.ok()) return made.status();
  }
  return absl::OkStatus();
}

/// The database's own clock.
absl::StatusOr<SystemTime> DatabaseTime(Connection& connection) {
  const auto answer = connection.RunOne(StoreCallOf(kNow), kDoing);
  if (!answer.ok()) return answer.status();
  return answer->Time(0, 0);
}

absl::StatusOr<Erased> EraseAll(Connection& connection, SystemTime now, const StoreRules& rules,
                                QuarantineDays& days) {
  Eraser eraser(connection, days);
  if (const auto kept = FirstDayKept(now, rules.retain_history)) {
    const absl::Status status = eraser.EraseLists<Retained::kAsHistory>(*kept);
    if (!status.ok()) return status;
  }
  if (const auto kept = FirstDayKept(now, rules.retain_quarantine)) {
    const absl::Status status = eraser.EraseLists<Retained::kAsSetAside>(*kept);
    if (!status.ok()) return status;
  }
  if (const auto kept = FirstDayKept(now, rules.retain_connections)) {
    const absl::Status status = eraser.EraseLists<Retained::kAsConnections>(*kept);
    if (!status.ok()) return status;
  }
  if (const auto kept = FirstDayKept(now, rules.retain_audit)) {
    const absl::Status status = eraser.EraseAudit(*kept);
    if (!status.ok()) return status;
  }
  return eraser.erased();
}

/// A lock that was not free in time is retention's own trouble: the server is there.
absl::Status Told(const Connection& connection, const absl::Status& status) {
  if (!absl::IsUnavailable(status) || connection.broken()) return status;
  return absl::AbortedError(status.message());
}

}  // namespace

absl::StatusOr<Erased> QuarantineDays::Erase(Connection& connection, SystemTime until) {
  Erased erased;
  const absl::Status emptied = EmptyDays(connection, until, erased);
  if (!emptied.ok()) return emptied;
  const auto others =
      RunAlone(connection, StoreCallOf(kEraseDefault, until, kRetainRowsMax), kDoingQuarantine);
  if (!others.ok()) return others.status();
  const std::size_t rows = Count(*others, 0);
  erased.rows += rows;
  erased.rejects_kept += Count(*others, 1);
  if (rows == kRetainRowsMax) erased.more = true;
  return erased;
}

absl::Status QuarantineDays::EmptyDays(Connection& connection, SystemTime until, Erased& erased) {
  std::size_t rows = 0;
  std::size_t days = 0;
  while (rows < kRetainRowsMax && days < kDaysPerCallMax) {
    const auto left = static_cast<std::int32_t>(kRetainRowsMax - rows);
    const auto taken =
        RunAlone(connection, StoreCallOf(kTake, until, since_, left), kDoingQuarantine);
    if (!taken.ok()) return taken.status();
    if (!taken->Bool(0, 0)) {
      since_ = SystemTime();
      return absl::OkStatus();
    }
    const std::size_t went = Count(*taken, 2);
    const SystemTime looked_from = std::exchange(since_, went > 0 ? taken->Time(0, 1) : since_);
    rows += went;
    erased.rows += went;
    erased.rejects_kept += Count(*taken, 3);
    if (rows == kRetainRowsMax) break;
    const auto dropped = RunAlone(connection, StoreCallOf(kDrop, until), kDoingQuarantine);
    if (!dropped.ok()) return dropped.status();
    days += Count(*dropped, 0);
    erased.rows += Count(*dropped, 0);
    if (Count(*dropped, 0) > 0) continue;
    // A row that was committed late lies before what was looked at, or came just now.
    since_ = SystemTime();
    if (looked_from == SystemTime()) break;
  }
  erased.more = true;
  return absl::OkStatus();
}

absl::StatusOr<Erased> RetainRows(Connection& connection, SystemTime now, const StoreRules& rules,
                                  QuarantineDays& days) {
  if (!Vouches(rules.clock, now)) {
    const absl::StatusOr<SystemTime> today = DatabaseTime(connection);
    if (!today.ok()) return Told(connection, today.status());
    const absl::Status made = MakePartitions(connection, *today);
    if (!made.ok()) return Told(connection, made);
    return Erased();
  }
  const absl::Status made = MakePartitions(connection, now);
  if (connection.broken()) return made;
  // What cannot be made keeps nothing from being dropped.
  auto erased = EraseAll(connection, now, rules, days);
  if (!erased.ok()) return Told(connection, erased.status());
  if (!made.ok()) return Told(connection, made);
  return erased;
}

}  // namespace uplink::storage::postgres
