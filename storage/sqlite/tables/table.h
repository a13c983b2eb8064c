#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/sqlite/statement.h"
#include "storage/table_text.h"

// A table as one description: each column is named once, with how a row is written and how a list
// reads it. The statements are made from that.
namespace uplink::storage::sqlite {

/// The parameters of one run of a statement, in order. What is bound must outlive the run, but for
/// texts that are handed over. Confined to the thread of the statement.
class Binder final {
 public:
  explicit Binder(Statement& statement) : statement_(statement) {}

  void Int(std::int64_t value) { statement_.Bind(++index_, value); }
  void Int(std::int32_t value) { statement_.Bind(++index_, value); }
  /// Up to 2^63-1.
  void Int(std::uint64_t value) { statement_.Bind(++index_, value); }
  void Real(double value) { statement_.Bind(++index_, value); }
  void Time(SystemTime value) { statement_.Bind(++index_, UnixMs(value)); }
  void Text(std::string_view value) { statement_.Bind(++index_, value); }
  /// A text that was made for this run; at most kMadeMax.
  void Made(std::string text) {
    UPLINK_CHECK(made_count_ < kMadeMax, "a row has more made texts than there is room for");
    std::string& kept = made_.at(made_count_++);
    kept = std::move(text);
    Text(kept);
  }
  void Bytes(std::string_view value) { statement_.Bind(++index_, Blob{value}); }
  void Session(const model::SessionId& value) { Bytes(value.AsBytes()); }
  void Null() { statement_.Bind(++index_, Blob{}); }

  /// Runs the statement, which gives no rows.
  [[nodiscard]] absl::Status Run() { return statement_.Run(); }

 private:
  static constexpr std::size_t kMadeMax = 2;

  Statement& statement_;
  int index_ = 0;
  std::array<std::string, kMadeMax> made_;
  std::size_t made_count_ = 0;
};

/// One value of a list's row. What no program of ours wrote is told through `status`.
class Cell final {
 public:
  Cell(const Rows& rows, int column, absl::Status& status)
      : rows_(rows), column_(column), status_(status) {}

  [[nodiscard]] std::string Text() const { return std::string(rows_.Bytes(column_)); }
  [[nodiscard]] std::int64_t Int() const { return rows_.Int(column_); }
  [[nodiscard]] double Real() const { return rows_.Real(column_); }
  [[nodiscard]] SystemTime Time() const { return FromUnixMs(rows_.Int(column_)); }
  [[nodiscard]] model::SessionId Session() const {
    const auto session = model::SessionId::FromBytes(rows_.Bytes(column_));
    if (!session) status_ = absl::InternalError("a session in the store is not 16 bytes");
    return session.value_or(model::SessionId());
  }

 private:
  const Rows& rows_;
  const int column_;
  absl::Status& status_;
};

/// Reads one value of a list's row.
template <typename Out>
using Read = void (*)(const Cell& cell, Out& row);

/// In: what a row is written from. Out: a list's row.
template <typename In, typename Out>
struct Column {
  std::string_view name;
  Role role = Role::kValue;
  /// Binds one value.
  void (*bind)(Binder& to, const In& row) = nullptr;
  /// Not set: lists leave the column out. Not a null pointer: with UBSan, GCC 12 takes no
  /// comparison of a function's address for a constant.
  std::optional<Read<Out>> read = std::nullopt;
  /// SQL that makes the inserted value of the bound one, `?`; empty: it is that one.
  std::string_view value = {};
  /// SQL of an update's value, where it is not the inserted one.
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

/// Writes one row. The parameters are the columns, in order.
template <typename In, typename Out, std::size_t kColumns>
constexpr SqlText InsertSql(const Table<In, Out, kColumns>& table) {
  SqlText names;
  SqlText values;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Column<In, Out>& column = table.columns[i];
    const std::string_view comma = i == 0 ? "" : ", ";
    names.Add({comma, column.name});
    values.Add({comma, column.value.empty() ? std::string_view("?") : column.value});
  }
  return {"INSERT INTO ", table.name,    " (", names.view(),
          ") VALUES (",   values.view(), ")",  ConflictSql(table).view()};
}

}  // namespace uplink::storage::sqlite
