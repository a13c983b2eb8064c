#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/link/parameters.h"
#include "storage/postgres/link/result.h"
#include "storage/table_text.h"

// A table as one description: each column is named once, with its type, how a batch fills it and
// how a list reads it. The statements are made from that.
namespace uplink::storage::postgres {

/// One value of a list's row.
class Cell final {
 public:
  Cell(const Result& rows, int row, int column) : rows_(rows), row_(row), column_(column) {}

  [[nodiscard]] std::string Text() const { return std::string(rows_.Bytes(row_, column_)); }
  [[nodiscard]] std::int64_t Int() const { return rows_.Int(row_, column_); }
  [[nodiscard]] bool Bool() const { return rows_.Bool(row_, column_); }
  [[nodiscard]] double Real() const { return rows_.Real(row_, column_); }
  [[nodiscard]] SystemTime Time() const { return rows_.Time(row_, column_); }
  [[nodiscard]] model::SessionId Uuid() const { return rows_.Uuid(row_, column_); }

 private:
  const Result& rows_;
  const int row_;
  const int column_;
};

/// Reads one value of a list's row.
template <typename Out>
using Read = void (*)(const Cell& cell, Out& row);

/// In: what a batch makes a row of. Out: a list's row.
template <typename In, typename Out>
struct Column {
  std::string_view name;
  Type type = Type::kText;
  Role role = Role::kValue;
  /// Adds one value.
  void (*fill)(Array& array, const In& row) = nullptr;
  /// Not set: lists leave the column out. Not a null pointer: with UBSan, GCC 12 takes no
  /// comparison of a function's address for a constant.
  std::optional<Read<Out>> read = std::nullopt;
  /// SQL that makes the inserted value of the filled one; empty: it is that one.
  std::string_view value = {};
  /// SQL of an update's value, where it is not the inserted one; the table is `t`.
  std::string_view update = {};
};

template <typename InRow, typename Out, std::size_t kColumns>
struct Table {
  using In = InRow;
  using ListRow = Out;

  std::string_view name;
  Writes writes = Writes::kInserts;
  Listed<Out> listed;
  std::array<Column<In, Out>, kColumns> columns;
};

/// Types as SQL names them.
constexpr std::string_view SqlName(Type type) {
  switch (type) {
    case Type::kBool:
      return "bool";
    case Type::kBytes:
      return "bytea";
    case Type::kInt8:
      return "bigint";
    case Type::kInt4:
      return "int";
    case Type::kText:
      return "text";
    case Type::kFloat8:
      return "float8";
    case Type::kTime:
      return "timestamptz";
    case Type::kUuid:
      return "uuid";
  }
  return {};
}

/// Writes rows. The parameters are the columns, each an array, in order.
template <typename In, typename Out, std::size_t kColumns>
constexpr SqlText InsertSql(const Table<In, Out, kColumns>& table) {
  SqlText names;
  SqlText values;
  SqlText arrays;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Column<In, Out>& column = table.columns[i];
    const std::string_view comma = i == 0 ? "" : ", ";
    names.Add({comma, column.name});
    values.Add({comma, column.value.empty() ? column.name : column.value});
    arrays.Add(comma);
    arrays.AddParameter(i + 1, SqlName(column.type));
    arrays.Add("[]");
  }
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
  for (const auto& column : kTable.columns) arrays.emplace_back(column.type);
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < arrays.size(); ++i) kTable.columns[i].fill(arrays[i], row);
  }
  StoreCall& call = calls.emplace_back(StoreCall{kSql.view(), {}});
  for (Array& array : arrays) call.parameters.Add(std::move(array));
}

}  // namespace uplink::storage::postgres
