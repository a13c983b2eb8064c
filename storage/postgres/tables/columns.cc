#include "storage/postgres/tables/columns.h"

#include <cstdint>
#include <variant>

namespace uplink::storage::postgres {
namespace {

/// One overload per value that a column may have.
struct Adder {
  Array& array;
  ColumnType type;

  void operator()(std::monostate /*null*/) const { array.Null(); }
  void operator()(bool value) const { array.Bool(value); }
  void operator()(std::int64_t value) const {
    if (SentType(type) == Type::kInt4) {
      array.Int4(static_cast<std::int32_t>(value));
    } else {
      array.Int8(value);
    }
  }
  void operator()(double value) const { array.Float8(value); }
  void operator()(SystemTime value) const { array.Time(value); }
  void operator()(const model::SessionId& value) const { array.Uuid(value); }
  void operator()(std::string_view value) const { array.Bytes(value); }
};

}  // namespace

void AddColumn(Array& array, ColumnType type, const ColumnValue& value) {
  std::visit(Adder{array, type}, value);
}

ColumnValue ReadColumn(const ResultRow& row, int index, ColumnType type) {
  if (row.Null(index)) return {};
  switch (type) {
    case ColumnType::kBool:
      return row.Bool(index);
    case ColumnType::kInt4:
    case ColumnType::kInt8:
    case ColumnType::kEntry:
      return row.Int(index);
    case ColumnType::kReal:
      return row.Real(index);
    case ColumnType::kText:
    case ColumnType::kBytes:
      return row.Bytes(index);
    case ColumnType::kTime:
      return row.Time(index);
    case ColumnType::kSession:
      return row.Uuid(index);
  }
  return {};
}

}  // namespace uplink::storage::postgres
