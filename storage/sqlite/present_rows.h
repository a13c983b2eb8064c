#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/present.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// What the rows of all kinds that are present by key have in common: active faults, shapes or
/// objects. How the tables differ is a row of a table in present_rows.cc.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class PresentRows final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database, PresentKind kind);

  /// When the row expires, 0: never; nothing if there is none.
  [[nodiscard]] absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(const PresentKey& key);
  /// A robot's rows, expired ones included.
  [[nodiscard]] absl::StatusOr<std::size_t> Count(std::string_view ruri);
  [[nodiscard]] absl::Status Delete(const PresentKey& key);

  // Of kinds that expire alone.

  /// Deletes a robot's rows that have expired by `now_ms`; returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> DeleteExpired(std::string_view ruri,
                                                          std::int64_t now_ms);
  /// Deletes at most `rows_max` rows that expired by `until_ms`, the first to expire first.
  [[nodiscard]] absl::StatusOr<std::size_t> Sweep(std::int64_t until_ms, std::size_t rows_max);

 private:
  /// Begins a run of a statement whose parameters are the columns of the key.
  [[nodiscard]] Rows SelectKey(Statement& statement, const PresentKey& key) const;

  bool has_source_ = false;
  std::unique_ptr<Statement> expiry_, count_, delete_, delete_expired_, sweep_;
};

}  // namespace uplink::storage::sqlite
