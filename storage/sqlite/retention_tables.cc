#include "storage/sqlite/retention_tables.h"

#include <algorithm>
#include <string>

#include "schema/base/check.h"
#include "storage/bounds.h"
#include "storage/retention.h"
#include "storage/rows.h"
#include "storage/shared_items.h"
#include "storage/tables/lists.h"

namespace uplink::storage::sqlite {
namespace {

template <typename Table>
std::string EraseSql(const Table& table) {
  const std::string name(table.name);
  const std::string time(table.listed.time_column);
  std::string sql = "DELETE FROM " + name + " WHERE rowid IN (SELECT rowid FROM " + name +
                    " WHERE " + time + " < ?1";
  if (!table.listed.last_column.empty()) {
    sql.append(" AND ").append(table.listed.last_column).append(" < ?1");
  }
  if (!table.listed.open_column.empty()) sql.append(" AND NOT ").append(table.listed.open_column);
  return sql + " ORDER BY " + time + ", entry LIMIT ?2) RETURNING 1";
}

}  // namespace

absl::Status RetentionTables::Prepare(Database& database) {
  Preparer prepare(database);
  ForEachList([&]<PageKind kList>() {
    constexpr Retained kRetained = RetainedOf(kList);
    if constexpr (kRetained != Retained::kWhilePresent) {
      prepare.Into(StatementsOf(kRetained).emplace_back(), EraseSql(List<kList>::kTable));
    }
  });
  prepare.Into(audit_.emplace_back(), EraseSql(kAuditTable));
  // Those rows of quarantine that go next and that a Hello may still ask for.
  prepare.Into(
      keep_rejects_,
      "INSERT OR IGNORE INTO kept_rejects"
      " (ruri, session, last, first, entry, reason, field, detail)"
      " SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail"
      " FROM (SELECT ruri, session, seq, entry, source, reason, field, detail FROM quarantine"
      " WHERE received_at < ?1"
      " ORDER BY received_at, entry LIMIT ?2) AS q"
      " JOIN sessions AS s ON s.ruri = q.ruri AND s.session = q.session"
      " AND q.entry >= s.first_entry"
      " WHERE q.source = 0 AND q.seq > s.settled_seq RETURNING 1");
  prepare.Into(sweep_changes_,
               "DELETE FROM changes WHERE number <= (SELECT max(number) FROM changes) - ?1"
               " AND number < (SELECT min(number) FROM changes) + ?2 RETURNING number");
  const auto close = [](RunClosed why) {
    return "UPDATE mission_runs SET is_open = 0, closed_why = " +
           std::to_string(static_cast<int>(why)) +
           ", closed_at = ?1 WHERE rowid IN (SELECT rowid FROM mission_runs WHERE ";
  };
  prepare.Into(count_runs_, "SELECT COUNT(*) FROM mission_runs WHERE ruri = ? AND is_open");
  prepare.Into(close_over_, close(RunClosed::kForBound) +
                                "ruri = ?2 AND is_open"
                                " ORDER BY last_entry, last_at, entry LIMIT ?3)");
  // A run's last report is hardly ever older than its first one, by which the index goes.
  prepare.Into(close_old_, close(RunClosed::kForAge) +
                               "first_at < ?2 AND last_at < ?2 AND is_open"
                               " ORDER BY first_at, entry LIMIT ?3) RETURNING 1");
  return prepare.status();
}

RetentionTables::Statements& RetentionTables::StatementsOf(Retained retained) {
  switch (retained) {
    case Retained::kAsHistory:
      return history_;
    case Retained::kAsSetAside:
      return set_aside_;
    case Retained::kAsConnections:
      return connections_;
    case Retained::kWhilePresent:
      break;
  }
  CheckFailed(__FILE__, __LINE__, "retained", "a list whose rows go for their age");
}

absl::Status RetentionTables::EraseConnections(SystemTime until, Erased& erased) {
  return Erase(connections_, until, erased);
}

absl::Status RetentionTables::EraseAudit(SystemTime until, Erased& erased) {
  return Erase(audit_, until, erased);
}

absl::Status RetentionTables::EraseHistory(SystemTime until, Erased& erased) {
  return Erase(history_, until, erased);
}

absl::Status RetentionTables::EraseSetAside(SystemTime until, Erased& erased) {
  const absl::StatusOr<std::size_t> kept = keep_rejects_->Select(until, kRetainRowsMax).Count();
  if (!kept.ok()) return kept.status();
  erased.rejects_kept += *kept;
  return Erase(set_aside_, until, erased);
}

absl::Status RetentionTables::Erase(const Statements& statements, SystemTime until,
                                    Erased& erased) {
  for (const std::unique_ptr<Statement>& statement : statements) {
    const absl::StatusOr<std::size_t> rows = statement->Select(until, kRetainRowsMax).Count();
    if (!rows.ok()) return rows.status();
    erased.rows += *rows;
    if (*rows == kRetainRowsMax) erased.more = true;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::size_t> RetentionTables::SweepChanges() {
  return sweep_changes_->Select(kChangesKept, kChangesSweptMax).Count();
}

absl::StatusOr<std::size_t> RetentionTables::CloseOver(std::string_view ruri, SystemTime at) {
  const absl::StatusOr<std::int64_t> open = count_runs_->Select(ruri).OnlyInt();
  if (!open.ok()) return open.status();
  const auto runs = static_cast<std::size_t>(*open);
  if (runs <= kOpenRunsPerRobotMax) return 0;
  const std::size_t over = std::min(runs - kOpenRunsPerRobotMax, kSweepRowsMax);
  absl::Status closed = close_over_->Run(at, ruri, over);
  if (!closed.ok()) return closed;
  return over;
}

absl::StatusOr<std::size_t> RetentionTables::CloseOld(SystemTime until, SystemTime at) {
  return close_old_->Select(at, until, kSweepRowsMax).Count();
}

}  // namespace uplink::storage::sqlite
