#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/identity.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// The connections of robots: their bound, and the ends that their server did not tell.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class RobotConnections final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Deletes the oldest connections of the robot over kConnectionsPerRobotMax.
  [[nodiscard]] absl::Status Trim(std::string_view ruri);
  /// As Store::ProcessesWithOpenConnections; `self` is this process.
  [[nodiscard]] absl::StatusOr<std::vector<ProcessId>> Processes(const ProcessId& self);
  /// As Store::EndConnections: no process of this store has a lease.
  [[nodiscard]] absl::StatusOr<std::size_t> End(const ProcessId& process, SystemTime now);

 private:
  std::unique_ptr<Statement> trim_, processes_, end_;
};

}  // namespace uplink::storage::sqlite
