#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>

#include <absl/status/status.h>

#include "storage/sqlite/columns.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"
#include "storage/tables/lists.h"

namespace uplink::storage::sqlite {

/// A parameter for each column, in order.
template <typename Table>
constexpr SqlText PlacesSql(const Table& table) {
  SqlText places;
  for (std::size_t i = 0; i < table.columns.size(); ++i) places.Add(i == 0 ? "?" : ", ?");
  return places;
}

/// Writes one row. The parameters are the columns, in order.
template <typename Table>
constexpr SqlText InsertSql(const Table& table) {
  return {"INSERT INTO ",
          table.name,
          " AS t (",
          ColumnNames(table).view(),
          ") VALUES (",
          PlacesSql(table).view(),
          ")",
          ConflictSql(table).view()};
}

/// A row whose columns are bound to a statement, in order. It must live until the run has ended.
template <const auto& kTable>
class BoundRow final {
 public:
  using In = typename std::remove_cvref_t<decltype(kTable)>::In;
  static constexpr int kColumns = static_cast<int>(kTable.columns.size());

  BoundRow(Statement& statement, const In& row) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] = kTable.columns[i].value(row);
      BindColumn(statement, static_cast<int>(i) + 1, kTable.columns[i].type, values_[i]);
    }
  }
  BoundRow(const BoundRow&) = delete;
  BoundRow& operator=(const BoundRow&) = delete;

 private:
  std::array<ColumnValue, kTable.columns.size()> values_;
};

/// Writes rows of one table, which must be a constant: by the statement that its description makes.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
template <const auto& kTable>
class TableWriter final {
 public:
  using In = typename BoundRow<kTable>::In;

  void Prepare(Preparer& prepare) { prepare.Into(insert_, kSql.view()); }

  [[nodiscard]] absl::Status Write(const In& row) {
    const BoundRow<kTable> bound(*insert_, row);
    return insert_->Run();
  }

 private:
  static constexpr SqlText kSql = InsertSql(kTable);

  std::unique_ptr<Statement> insert_;
};

/// The writers of every table that a batch fills: those of the lists (storage/lists.h), and of what
/// is kept beside them.
///
/// Errors and thread: as TableWriter.
class TableWriters final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database) {
    Preparer prepare(database);
    std::apply([&prepare](auto&... writer) { (writer.Prepare(prepare), ...); }, writers_);
    return prepare.status();
  }

  template <const auto& kTable>
  [[nodiscard]] absl::Status Write(const typename TableWriter<kTable>::In& row) {
    return std::get<TableWriter<kTable>>(writers_).Write(row);
  }

 private:
#define UPLINK_LIST(Name, number, Row, Query, retained) , TableWriter<k##Name##Table>
  std::tuple<TableWriter<kLatestTable>, TableWriter<kLatestPresenceTable>,
             TableWriter<kKeptRejectsTable>, TableWriter<kSamplesTable> UPLINK_LISTS(UPLINK_LIST)>
      writers_;
#undef UPLINK_LIST
};

}  // namespace uplink::storage::sqlite
