#include "storage/postgres/write/retain.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/postgres/write/transaction.h"
#include "storage/retention.h"
#include "storage/tables/lists.h"

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
      StoreCall call{kDropPartitions, {}};
      call.parameters.Text(history);
      call.parameters.Time(until_);
      const auto some = RunAlone(connection_, std::move(call), kDoing);
      if (!some.ok()) return some.status();
      dropped = static_cast<std::size_t>(some->Int(0, 0));
      erased_.rows += dropped;
    }
    return absl::OkStatus();
  }
  absl::Status Erase(std::string_view sql) {
    StoreCall call{sql, {}};
    call.parameters.Time(until_);
    call.parameters.Int8(static_cast<std::int64_t>(kRetainRowsMax));
    const auto result = RunAlone(connection_, std::move(call), kDoing);
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
    StoreCall call{kMakePartitions, {}};
    call.parameters.Time(now + std::chrono::days(day));
    call.parameters.Int4(1);
    const auto made = RunAlone(connection, std::move(call), kDoing);
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
  return eraser.erased();
}

/// A lock that was not free in time is retention's own trouble: the server is there.
absl::Status Told(const Connection& connection, const absl::Status& status) {
  if (!absl::IsUnavailable(status) || connection.broken()) return status;
  return absl::AbortedError(status.message());
}

}  // namespace

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
