#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"

struct sqlite3_stmt;

namespace uplink::storage::sqlite {

class Database;

/// The number of a row in the order of writing, over all tables.
using EntryNumber = std::uint64_t;

/// Bytes to bind as a BLOB; nothing binds NULL.
struct Blob {
  std::optional<std::string_view> bytes;
};

/// The rows of one run of a statement; ends the run when it goes. Confined to one thread.
class Rows final {
 public:
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;
  ~Rows();

  /// Moves to the next row; false after the last. Nothing may be read before the first call.
  [[nodiscard]] absl::StatusOr<bool> Next();
  /// Gives each row that is left to `take`.
  template <typename Take>
  [[nodiscard]] absl::Status ForEach(const Take& take) {
    while (true) {
      const absl::StatusOr<bool> found = Next();
      if (!found.ok() || !*found) return found.status();
      take(*this);
    }
  }
  /// What `read` makes of each row that is left.
  template <typename Read, typename Made = std::invoke_result_t<Read, const Rows&>>
  [[nodiscard]] absl::StatusOr<std::vector<Made>> All(const Read& read) {
    std::vector<Made> all;
    absl::Status status = ForEach([&](const Rows& row) { all.push_back(read(row)); });
    if (!status.ok()) return status;
    return all;
  }
  /// What `read` makes of the first row; nothing if there is none.
  template <typename Read, typename Made = std::invoke_result_t<Read, const Rows&>>
  [[nodiscard]] absl::StatusOr<std::optional<Made>> First(const Read& read) {
    const absl::StatusOr<bool> found = Next();
    if (!found.ok()) return found.status();
    if (!*found) return std::optional<Made>();
    return std::optional<Made>(read(*this));
  }
  /// The integer of a statement that always gives a row; kInternal without one.
  [[nodiscard]] absl::StatusOr<std::int64_t> OnlyInt();
  /// How many rows are left: those of a deletion that returns each.
  [[nodiscard]] absl::StatusOr<std::size_t> Count();

  [[nodiscard]] std::int64_t Int(int column) const;
  [[nodiscard]] double Real(int column) const;
  [[nodiscard]] bool Null(int column) const;
  [[nodiscard]] bool Bool(int column) const { return Int(column) != 0; }
  [[nodiscard]] SystemTime Time(int column) const { return FromUnixMs(Int(column)); }
  /// Sixteen bytes; zeros for what no program of ours wrote.
  [[nodiscard]] model::SessionId Uuid(int column) const {
    return model::SessionId::FromBytes(Bytes(column)).value_or(model::SessionId());
  }
  /// Bytes of all texts and blobs of the row.
  [[nodiscard]] std::size_t TextBytes() const;
  /// TEXT or BLOB; valid until the next call of Next. NULL is empty.
  [[nodiscard]] std::string_view Bytes(int column) const;

 private:
  friend class Statement;
  Rows(class Statement& statement, int bind_code) : statement_(statement), code_(bind_code) {}

  class Statement& statement_;
  int code_;
};

/// A prepared statement. What is bound as text or BLOB must live until the run has ended.
///
/// Errors: those of errors.h.
/// Thread: confined to the thread of its database.
class Statement final {
 public:
  /// Use Database::Prepare.
  Statement(const Database& database, sqlite3_stmt* statement)
      : database_(&database), statement_(statement) {}

  /// Runs a statement that gives no rows, its parameters in order.
  template <typename... Args>
  [[nodiscard]] absl::Status Run(const Args&... args) {
    return Select(args...).Next().status();
  }

  /// Begins a run; the rows come by Rows::Next.
  template <typename... Args>
  [[nodiscard]] Rows Select(const Args&... args) {
    int code = 0;
    int index = 0;
    ((code = code == 0 ? BindAt(++index, args) : code), ...);
    return Rows(*this, code);
  }

  /// For parameters that are bound one by one, as a table's columns are: before Select() without
  /// arguments; the caller numbers from 1. The first Next returns the first failure.
  template <typename Arg>
  void Bind(int index, const Arg& arg) {
    const int code = BindAt(index, arg);
    if (pending_code_ == 0) pending_code_ = code;
  }

 private:
  friend class Rows;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };

  [[nodiscard]] int BindAt(int index, std::int64_t value);
  [[nodiscard]] int BindAt(int index, std::int32_t value) {
    return BindAt(index, std::int64_t{value});
  }
  /// Numbers up to 2^63-1; more is a mistake of ours and aborts.
  [[nodiscard]] int BindAt(int index, std::uint64_t value);
  [[nodiscard]] int BindAt(int index, double value);
  [[nodiscard]] int BindAt(int index, std::string_view text);
  [[nodiscard]] int BindAt(int index, const Blob& blob);
  [[nodiscard]] int BindAt(int index, SystemTime time) { return BindAt(index, UnixMs(time)); }
  [[nodiscard]] int BindAt(int index, const model::SessionId& id) {
    return BindAt(index, Blob{id.AsBytes()});
  }
  /// Of a process, or of a message.
  [[nodiscard]] int BindAt(int index, const std::array<std::uint8_t, 16>& bytes) {
    return BindAt(index, Blob{{{reinterpret_cast<const char*>(bytes.data()), bytes.size()}}});
  }
  template <typename Arg>
  [[nodiscard]] int BindAt(int index, const std::optional<Arg>& arg) {
    return arg ? BindAt(index, *arg) : BindAt(index, Blob{});
  }
  void Reset();

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int pending_code_ = 0;
};

}  // namespace uplink::storage::sqlite
