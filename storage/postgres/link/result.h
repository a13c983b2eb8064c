#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"

struct pg_result;

namespace uplink::storage::postgres {

class ResultRow;

/// The rows of one statement, in the binary protocol's form. Views live as long as the result.
///
/// Thread: as a value.
class Result final {
 public:
  explicit Result(pg_result* result) : result_(result) {}

  /// libpq's own; for connection.cc.
  [[nodiscard]] const pg_result* raw() const { return result_.get(); }

  [[nodiscard]] int rows() const;
  /// What was done: `COMMIT`, `INSERT 0 3`.
  [[nodiscard]] std::string_view tag() const;
  /// Rows that the statement wrote.
  [[nodiscard]] std::size_t written() const;

  [[nodiscard]] bool Null(int row, int column) const;
  [[nodiscard]] std::string_view Bytes(int row, int column) const;
  [[nodiscard]] bool Bool(int row, int column) const { return Unsigned(row, column) != 0; }
  /// Of an integer column of any width.
  [[nodiscard]] std::int64_t Int(int row, int column) const;
  [[nodiscard]] double Real(int row, int column) const;
  [[nodiscard]] SystemTime Time(int row, int column) const;
  [[nodiscard]] model::SessionId Uuid(int row, int column) const;
  /// Bytes of all columns of the row.
  [[nodiscard]] std::size_t RowBytes(int row) const;

  struct Iterator {
    const Result* rows = nullptr;
    int row = 0;
    [[nodiscard]] ResultRow operator*() const;
    Iterator& operator++() {
      ++row;
      return *this;
    }
    friend bool operator==(const Iterator&, const Iterator&) = default;
  };
  [[nodiscard]] Iterator begin() const { return {this, 0}; }
  [[nodiscard]] Iterator end() const { return {this, rows()}; }
  /// What `read` makes of each row.
  template <typename Read>
  [[nodiscard]] std::vector<std::invoke_result_t<Read, const ResultRow&>> All(
      const Read& read) const;

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };
  [[nodiscard]] std::uint64_t Unsigned(int row, int column) const;

  std::unique_ptr<pg_result, Clear> result_;
};

/// One row of a result, which must outlive it.
class ResultRow final {
 public:
  ResultRow(const Result& rows, int row) : rows_(&rows), row_(row) {}

  [[nodiscard]] bool Null(int column) const { return rows_->Null(row_, column); }
  [[nodiscard]] std::string_view Bytes(int column) const { return rows_->Bytes(row_, column); }
  [[nodiscard]] bool Bool(int column) const { return rows_->Bool(row_, column); }
  [[nodiscard]] std::int64_t Int(int column) const { return rows_->Int(row_, column); }
  [[nodiscard]] double Real(int column) const { return rows_->Real(row_, column); }
  [[nodiscard]] SystemTime Time(int column) const { return rows_->Time(row_, column); }
  [[nodiscard]] model::SessionId Uuid(int column) const { return rows_->Uuid(row_, column); }
  [[nodiscard]] std::size_t TextBytes() const { return rows_->RowBytes(row_); }

 private:
  const Result* rows_;
  int row_;
};

inline ResultRow Result::Iterator::operator*() const { return {*rows, row}; }

template <typename Read>
std::vector<std::invoke_result_t<Read, const ResultRow&>> Result::All(const Read& read) const {
  std::vector<std::invoke_result_t<Read, const ResultRow&>> all;
  all.reserve(static_cast<std::size_t>(rows()));
  for (const ResultRow& row : *this) all.push_back(read(row));
  return all;
}

}  // namespace uplink::storage::postgres
