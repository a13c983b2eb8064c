#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/ids.h"

struct pg_result;

namespace uplink::storage::postgres {

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

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };
  [[nodiscard]] std::uint64_t Unsigned(int row, int column) const;

  std::unique_ptr<pg_result, Clear> result_;
};

}  // namespace uplink::storage::postgres
