#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"
#include "storage/sql_text.h"

// What the descriptions of both stores' tables share. A store has its own types of columns and
// tables; a column has a name, a role and an update, and a read function where lists show it.
namespace uplink::storage {

/// What an upsert does to a column of a row that is there.
enum class Role : std::uint8_t {
  /// By the key's columns the row is found.
  kKey,
  /// The value is replaced.
  kValue,
  /// What the first insert wrote stays.
  kKept,
};

enum class Writes : std::uint8_t {
  /// Rows are only added, whatever the roles say.
  kInserts,
  /// A row that is there by its key is updated.
  kUpserts,
};

/// Of a table that no list reads.
struct Unlisted {};

/// How lists and retention go through a table: by `time_column`; entry breaks ties. Out: a list's
/// row.
template <typename Out>
struct Listed {
  std::string_view time_column;
  void (*read_time)(SystemTime time, Out& row) = nullptr;
  /// SQL: which rows count as open. Empty: there is no such difference.
  std::string_view open_if = {};
  /// SQL: which of the rows that are too old may go; the first parameter is the time. Empty: all.
  std::string_view erase_if = {};
};

/// Columns that several tables begin with, before their own.
template <typename Column, std::size_t kFirst, std::size_t kOwn>
constexpr std::array<Column, kFirst + kOwn> Join(const std::array<Column, kFirst>& first,
                                                 const std::array<Column, kOwn>& own) {
  std::array<Column, kFirst + kOwn> columns;
  for (std::size_t i = 0; i < kFirst; ++i) columns[i] = first[i];
  for (std::size_t i = 0; i < kOwn; ++i) columns[kFirst + i] = own[i];
  return columns;
}

/// What an insert does where the row is there: nothing but fail, or an update by the roles.
template <typename Table>
constexpr SqlText ConflictSql(const Table& table) {
  if (table.writes == Writes::kInserts) return {};
  SqlText keys;
  SqlText updates;
  for (const auto& column : table.columns) {
    if (column.role == Role::kKey) {
      keys.Add({keys.view().empty() ? std::string_view() : ", ", column.name});
    }
    if (column.role != Role::kValue) continue;
    updates.Add({updates.view().empty() ? std::string_view() : ", ", column.name, " = "});
    if (column.update.empty()) updates.Add({"excluded.", column.name});
    updates.Add(column.update);
  }
  return {" ON CONFLICT (", keys.view(), ") DO UPDATE SET ", updates.view()};
}

/// The columns that a list reads, in order.
template <typename Table>
constexpr SqlText ListedColumns(const Table& table) {
  SqlText sql;
  for (const auto& column : table.columns) {
    if (!column.read) continue;
    sql.Add({sql.view().empty() ? std::string_view() : ", ", column.name});
  }
  return sql;
}

}  // namespace uplink::storage
