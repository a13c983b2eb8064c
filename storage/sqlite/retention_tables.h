#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/lists.h"
#include "storage/retention.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Deletes what is past its retention, the oldest first, at most kRetainRowsMax rows of
/// each table a call; closes mission runs past their bound or their age.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class RetentionTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Histories, and mission runs that are closed. Adds what went to `erased`.
  [[nodiscard]] absl::Status EraseHistory(SystemTime until, Erased& erased);
  /// Quarantine and gaps. Keeps the Rejects that a Hello may still ask for.
  [[nodiscard]] absl::Status EraseSetAside(SystemTime until, Erased& erased);
  /// Connections that have ended.
  [[nodiscard]] absl::Status EraseConnections(SystemTime until, Erased& erased);
  /// Rows of the audit.
  [[nodiscard]] absl::Status EraseAudit(SystemTime until, Erased& erased);
  /// Deletes changes of items that triggers noted (shared_items.h) beyond kChangesKept, the oldest
  /// first, at most kChangesSweptMax. Returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> SweepChanges();
  /// Closes the robot's open runs over kOpenRunsPerRobotMax, those that were reported least
  /// recently first, at most kSweepRowsMax. Returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> CloseOver(std::string_view ruri, SystemTime at);
  /// Closes runs that were not reported since `until`, at most kSweepRowsMax. Returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> CloseOld(SystemTime until, SystemTime at);

 private:
  using Statements = std::vector<std::unique_ptr<Statement>>;
  [[nodiscard]] Statements& StatementsOf(Retained retained);
  static absl::Status Erase(const Statements& statements, SystemTime until, Erased& erased);

  Statements history_;
  Statements set_aside_;
  Statements connections_;
  Statements audit_;
  std::unique_ptr<Statement> keep_rejects_, sweep_changes_, count_runs_, close_over_, close_old_;
};

}  // namespace uplink::storage::sqlite
