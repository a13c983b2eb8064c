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

/// Writes rows. The parameters are the columns, each an array, in order.
template <typename Table>
constexpr SqlText InsertSql(const Table& table) {
  SqlText values;
  SqlText arrays;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const auto& column = table.columns[i];
    const std::string_view comma = i == 0 ? "" : ", ";
    // The transaction's number, of which entries are made, is read once per statement.
    const bool entry = column.type == ColumnType::kEntry;
    values.Add({comma, entry ? "(SELECT currval('uplinkd.batches') << 20) + " : "", column.name});
    arrays.Add(comma);
    arrays.AddParameter(i + 1, SqlName(SentType(column.type)));
    arrays.Add("[]");
  }
  const SqlText names = ColumnNames(table);
  return {"INSERT INTO uplinkd.", table.name,    " AS t (",
          names.view(),           ") SELECT ",   values.view(),
          " FROM unnest(",        arrays.view(), ") AS u (",
          names.view(),           ")",           ConflictSql(table).view()};
}

/// Adds the statement that writes the rows, if there are any. `kTable` is a constant, so that the
/// statement's text is one too.
template <const auto& kTable, typename Rows>
void AddInsert(const Rows& rows, std::vector<StoreCall>& calls) {
  static constexpr SqlText kSql = InsertSql(kTable);
  if (rows.empty()) return;
  std::vector<Array> arrays;
  arrays.reserve(kTable.columns.size());
  for (const auto& column : kTable.columns) arrays.emplace_back(SentType(column.type));
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      AddColumn(arrays[i], kTable.columns[i].type, kTable.columns[i].value(row));
    }
  }
  StoreCall& call = calls.emplace_back(StoreCall{kSql.view(), {}});
  for (Array& array : arrays) call.parameters.Add(std::move(array));
}

}  // namespace uplink::storage::postgres
