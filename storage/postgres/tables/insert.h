#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/postgres/link/connection.h"
#include "storage/postgres/tables/columns.h"
#include "storage/tables/table.h"

// The statement by which a batch writes the rows of a table.
namespace uplink::storage::postgres {

/// The columns as parameters, each an array, in order.
template <typename Table>
constexpr SqlText ArraysSql(const Table& table) {
  SqlText arrays;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    arrays.Add(i == 0 ? "" : ", ");
    arrays.AddParameter(i + 1, SqlName(SentType(table.columns[i].type)));
    arrays.Add("[]");
  }
  return arrays;
}

/// Writes rows. `with`: what goes before the statement; `where`: which of the rows `u` it writes.
template <typename Table>
constexpr SqlText InsertSql(const Table& table, std::string_view with = {},
                            std::string_view where = {}) {
  SqlText values;
  for (const auto& column : table.columns) {
    // Entries are made from the transaction's number, which is read once per statement.
    const bool entry = column.type == ColumnType::kEntry;
    values.Add({values.view().empty() ? "" : ", ",
                entry ? "(SELECT currval('uplinkd.batches') << 20) + " : "", column.name});
  }
  const SqlText names = ColumnNames(table);
  return {with,
          "INSERT INTO uplinkd.",
          table.name,
          " AS t (",
          names.view(),
          ") SELECT ",
          values.view(),
          " FROM unnest(",
          ArraysSql(table).view(),
          ") AS u (",
          names.view(),
          ")",
          where,
          ConflictSql(table).view()};
}

/// A row of a vector, or of a map by its key.
template <typename Row>
constexpr const Row& RowIn(const Row& row) {
  return row;
}
template <typename Key, typename Row>
constexpr const Row& RowIn(const std::pair<const Key, Row>& keyed) {
  return keyed.second;
}

/// A statement whose first parameters are the rows' columns.
template <const auto& kTable, typename Rows>
[[nodiscard]] StoreCall CallWithRows(std::string_view sql, const Rows& rows) {
  std::vector<Array> arrays;
  arrays.reserve(kTable.columns.size());
  for (const auto& column : kTable.columns) arrays.emplace_back(SentType(column.type));
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      AddColumn(arrays[i], kTable.columns[i].type, kTable.columns[i].value(RowIn(row)));
    }
  }
  StoreCall call{sql, {}};
  for (Array& array : arrays) call.parameters.Add(&array);
  return call;
}

/// Adds the statement that writes the rows, if there are any. `kTable` is a constant, so that the
/// statement's text is one too.
template <const auto& kTable, typename Rows>
void AddInsert(const Rows& rows, std::vector<StoreCall>& calls) {
  static constexpr SqlText kSql = InsertSql(kTable);
  if (!rows.empty()) calls.push_back(CallWithRows<kTable>(kSql.view(), rows));
}

}  // namespace uplink::storage::postgres
