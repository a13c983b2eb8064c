#pragma once

#include <string_view>

#include "storage/postgres/link/parameters.h"
#include "storage/postgres/link/result.h"
#include "storage/tables/column.h"

// How the values of tables' columns lie in the database.
namespace uplink::storage::postgres {

/// What a batch sends for a column; of an entry its place.
constexpr Type SentType(ColumnType type) {
  switch (type) {
    case ColumnType::kBool:
      return Type::kBool;
    case ColumnType::kInt4:
    case ColumnType::kEntry:
      return Type::kInt4;
    case ColumnType::kInt8:
      return Type::kInt8;
    case ColumnType::kReal:
      return Type::kFloat8;
    case ColumnType::kText:
      return Type::kText;
    case ColumnType::kBytes:
      return Type::kBytes;
    case ColumnType::kTime:
      return Type::kTime;
    case ColumnType::kSession:
      return Type::kUuid;
  }
  return Type::kText;
}

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

/// Adds a value to the array of its column.
void AddColumn(Array& array, ColumnType type, const ColumnValue& value);

/// A view in the value lives as long as the result.
[[nodiscard]] ColumnValue ReadColumn(const ResultRow& row, int index, ColumnType type);

}  // namespace uplink::storage::postgres
