#pragma once

#include <memory>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/remember.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// What a commit asks and writes of leases on topics: their epochs, and what is remembered of
/// deliveries.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class TopicTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// 0 if the client id has no lease, or another process has it.
  [[nodiscard]] absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id,
                                                 const ProcessId& process);
  [[nodiscard]] absl::Status Write(const DeliveryChanges& changes);

 private:
  std::unique_ptr<Statement> epoch_, insert_, erase_;
};

}  // namespace uplink::storage::sqlite
