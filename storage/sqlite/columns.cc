#include "storage/sqlite/columns.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

namespace uplink::storage::sqlite {
namespace {

/// One overload per value that a column may have.
struct Binder {
  Statement& statement;
  int index;
  ColumnType type;

  void operator()(std::monostate /*null*/) const { statement.Bind(index, Blob{}); }
  void operator()(bool value) const { statement.Bind(index, std::int64_t{value}); }
  void operator()(std::int64_t value) const { statement.Bind(index, value); }
  void operator()(double value) const { statement.Bind(index, value); }
  void operator()(SystemTime value) const { statement.Bind(index, UnixMs(value)); }
  void operator()(const model::SessionId& value) const {
    statement.Bind(index, Blob{value.AsBytes()});
  }
  void operator()(std::string_view value) const {
    if (type == ColumnType::kBytes) {
      statement.Bind(index, Blob{value});
    } else {
      statement.Bind(index, value);
    }
  }
};

}  // namespace

void BindColumn(Statement& statement, int index, ColumnType type, const ColumnValue& value) {
  std::visit(Binder{statement, index, type}, value);
}

ColumnValue ReadColumn(const Rows& rows, int index, ColumnType type, absl::Status& status) {
  if (rows.Null(index)) return {};
  switch (type) {
    case ColumnType::kBool:
      return rows.Int(index) != 0;
    case ColumnType::kInt4:
    case ColumnType::kInt8:
    case ColumnType::kEntry:
      return rows.Int(index);
    case ColumnType::kReal:
      return rows.Real(index);
    case ColumnType::kText:
    case ColumnType::kBytes:
      return rows.Bytes(index);
    case ColumnType::kTime:
      return FromUnixMs(rows.Int(index));
    case ColumnType::kSession: {
      const auto session = model::SessionId::FromBytes(rows.Bytes(index));
      if (!session) status = absl::InternalError("a session in the store is not 16 bytes");
      return session.value_or(model::SessionId());
    }
  }
  return {};
}

}  // namespace uplink::storage::sqlite
