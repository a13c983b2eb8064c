#include "storage/sqlite/retention_tables.h"

#include <string>
#include <string_view>

#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {
namespace {

std::string EraseSql(std::string_view table, std::string_view time) {
  const std::string name(table);
  const std::string column(time);
  return "DELETE FROM " + name + " WHERE rowid IN (SELECT rowid FROM " + name + " WHERE " + column +
         " < ?1 ORDER BY " + column + ", entry LIMIT ?2) RETURNING 1";
}

// By the first report, for which there is an index.
constexpr std::string_view kEraseRuns =
    "DELETE FROM mission_runs WHERE rowid IN (SELECT rowid FROM mission_runs WHERE first_ms < ?1"
    " AND last_ms < ?1 AND status IN (6, 7, 8) ORDER BY first_ms, entry LIMIT ?2) RETURNING 1";

}  // namespace

absl::Status RetentionTables::Prepare(Database& database) {
  Preparer prepare(database);
  for (const std::string_view table : {"faults_history", "events", "messages", "mission_reports"}) {
    prepare.Into(history_.emplace_back(), EraseSql(table, "received_ms"));
  }
  prepare.Into(history_.emplace_back(), EraseSql("presence_changes", "at_ms"));
  prepare.Into(history_.emplace_back(), std::string(kEraseRuns));
  prepare.Into(set_aside_.emplace_back(), EraseSql("quarantine", "received_ms"));
  prepare.Into(set_aside_.emplace_back(), EraseSql("gaps", "seen_ms"));
  return prepare.status();
}

absl::StatusOr<std::size_t> RetentionTables::EraseHistory(SystemTime until) {
  return Erase(history_, until);
}

absl::StatusOr<std::size_t> RetentionTables::EraseSetAside(SystemTime until) {
  return Erase(set_aside_, until);
}

absl::StatusOr<std::size_t> RetentionTables::Erase(const Statements& statements, SystemTime until) {
  std::size_t erased = 0;
  for (const std::unique_ptr<Statement>& statement : statements) {
    const absl::StatusOr<std::size_t> rows =
        CountReturned(statement->Select(UnixMs(until), static_cast<std::int64_t>(kRetainRowsMax)));
    if (!rows.ok()) return rows.status();
    erased += *rows;
  }
  return erased;
}

}  // namespace uplink::storage::sqlite
