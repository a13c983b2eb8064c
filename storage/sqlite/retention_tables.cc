#include "storage/sqlite/retention_tables.h"

#include <string>

#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/tables/lists.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {
namespace {

template <typename Table>
std::string EraseSql(const Table& table) {
  const std::string name(table.name);
  const std::string time(table.listed.time_column);
  std::string sql = "DELETE FROM " + name + " WHERE rowid IN (SELECT rowid FROM " + name +
                    " WHERE " + time + " < ?1";
  if (!table.listed.erase_if.empty()) sql.append(" AND ").append(table.listed.erase_if);
  return sql + " ORDER BY " + time + ", entry LIMIT ?2) RETURNING 1";
}

}  // namespace

absl::Status RetentionTables::Prepare(Database& database) {
  Preparer prepare(database);
  ForEachList([&]<PageKind kList>() {
    constexpr Retained kRetained = RetainedOf(kList);
    if constexpr (kRetained != Retained::kWhilePresent) {
      Statements& statements = kRetained == Retained::kAsHistory ? history_ : set_aside_;
      prepare.Into(statements.emplace_back(), EraseSql(ListTable<kList>::kTable));
    }
  });
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
