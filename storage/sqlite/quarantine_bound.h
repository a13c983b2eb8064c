#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/retention.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Keeps the quarantine of a robot to its bound, and counts what went.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class QuarantineBound final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// As Store::TrimQuarantine, within a transaction.
  [[nodiscard]] absl::StatusOr<Trimmed> Trim(std::span<const std::string> ruris);

 private:
  /// Deletes up to `rows_max` rows that may go; returns how many.
  absl::StatusOr<std::size_t> TrimOne(std::string_view ruri, std::int64_t rows_max,
                                      Trimmed& trimmed);

  std::unique_ptr<Statement> count_, trim_, add_;
};

}  // namespace uplink::storage::sqlite
