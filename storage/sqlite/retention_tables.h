#pragma once

#include <memory>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "storage/retention.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Deletes what is older than it is to be kept, the oldest first, at most kRetainRowsMax rows of
/// each table a call.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class RetentionTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Histories, and mission runs that are closed. Adds what went to `erased`.
  [[nodiscard]] absl::Status EraseHistory(SystemTime until, Erased& erased);
  /// Quarantine and gaps. Keeps the Rejects that a Hello may still ask for.
  [[nodiscard]] absl::Status EraseSetAside(SystemTime until, Erased& erased);

 private:
  using Statements = std::vector<std::unique_ptr<Statement>>;
  static absl::Status Erase(const Statements& statements, SystemTime until, Erased& erased);

  Statements history_;
  Statements set_aside_;
  std::unique_ptr<Statement> keep_rejects_;
};

}  // namespace uplink::storage::sqlite
