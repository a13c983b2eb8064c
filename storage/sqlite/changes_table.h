#pragma once

#include <cstddef>
#include <memory>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// The changes of items that triggers note (shared_items.h), as far as the writer looks after them.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class ChangesTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Deletes what is beyond kChangesKept, the oldest first, at most kChangesSweptMax rows. Returns
  /// how many.
  [[nodiscard]] absl::StatusOr<std::size_t> Sweep();

 private:
  std::unique_ptr<Statement> sweep_;
};

}  // namespace uplink::storage::sqlite
