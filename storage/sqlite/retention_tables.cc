#include "storage/sqlite/retention_tables.h"

#include <string>

#include "storage/bounds.h"
#include "storage/retention.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"
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
      Statements& statements = kRetained == Retained::kAsHistory ? history_ : set_aside_;
      prepare.Into(statements.emplace_back(), EraseSql(List<kList>::kTable));
    }
  });
  // The rows of quarantine that go next, as far as a Hello may still ask for them.
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
  return prepare.status();
}

absl::Status RetentionTables::EraseHistory(SystemTime until, Erased& erased) {
  return Erase(history_, until, erased);
}

absl::Status RetentionTables::EraseSetAside(SystemTime until, Erased& erased) {
  const absl::StatusOr<std::size_t> kept = CountReturned(
      keep_rejects_->Select(UnixMs(until), static_cast<std::int64_t>(kRetainRowsMax)));
  if (!kept.ok()) return kept.status();
  erased.rejects_kept += *kept;
  return Erase(set_aside_, until, erased);
}

absl::Status RetentionTables::Erase(const Statements& statements, SystemTime until,
                                    Erased& erased) {
  for (const std::unique_ptr<Statement>& statement : statements) {
    const absl::StatusOr<std::size_t> rows =
        CountReturned(statement->Select(UnixMs(until), static_cast<std::int64_t>(kRetainRowsMax)));
    if (!rows.ok()) return rows.status();
    erased.rows += *rows;
    if (*rows == kRetainRowsMax) erased.more = true;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
