#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"
#include "storage/sql_text.h"
#include "storage/tables/column.h"

// A table as one description, for every store: its columns are named once.
namespace uplink::storage {

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
  /// The column that says which rows are open. Retention leaves those. Empty: there is no such
  /// difference.
  std::string_view open_column = {};
  /// The column that must be too old as well for a row to go. Empty: none.
  std::string_view last_column = {};
};

template <typename InRow, typename Out, std::size_t kColumns>
struct Table {
  using In = InRow;
  using ListRow = Out;

  std::string_view name;
  Writes writes = Writes::kInserts;
  Listed<Out> listed;
  std::array<Column<In, Out>, kColumns> columns;
  /// SQL of the rows among which the key finds one; empty: all.
  std::string_view keyed_rows = {};
  /// SQL of the rows `t` that an upsert updates; it leaves others as they are. Empty: all.
  std::string_view updated_rows = {};
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

/// The columns' names, in order.
template <typename Table>
constexpr SqlText ColumnNames(const Table& table) {
  SqlText sql;
  for (const auto& column : table.columns) {
    sql.Add({sql.view().empty() ? std::string_view() : ", ", column.name});
  }
  return sql;
}

/// The columns that a list reads, in order.
template <typename Table>
constexpr SqlText ListedColumns(const Table& table) {
  SqlText sql;
  for (const auto& column : table.columns) {
    if (!column.take) continue;
    sql.Add({sql.view().empty() ? std::string_view() : ", ", column.name});
  }
  return sql;
}

/// What an insert does where the row `t` exists: it fails, or updates by the columns' roles.
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
  return {" ON CONFLICT (",
          keys.view(),
          ")",
          table.keyed_rows.empty() ? "" : " WHERE ",
          table.keyed_rows,
          " DO UPDATE SET ",
          updates.view(),
          table.updated_rows.empty() ? "" : " WHERE ",
          table.updated_rows};
}

}  // namespace uplink::storage
