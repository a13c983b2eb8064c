#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/connection.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"
#include "storage/tables/connections.h"

// The connections of robots: how a batch writes them, and the ends that their server did not tell.
namespace uplink::storage::postgres {

/// The connections of one batch, which must outlive it: each is written once, as it was noted last.
class ConnectionRows final {
 public:
  void Add(const ConnectionItem& item, std::int32_t place);
  /// Adds the statements that write those whose robots have rows, and trim these robots to
  /// kConnectionsPerRobotMax. A robot that is forgotten meanwhile keeps none: its row is locked.
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  std::map<std::pair<std::string_view, ConnectionId>, NotedConnection> rows_;
};

/// Store::ProcessesWithOpenConnections; `self` is this process.
[[nodiscard]] absl::StatusOr<std::vector<ProcessId>> ProcessesWithOpenConnections(
    Connection& connection, const ProcessId& self);

/// Store::EndConnections, in one transaction.
[[nodiscard]] absl::StatusOr<std::size_t> EndConnections(
    Connection& connection, const ProcessId& process, SystemTime now,
    const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
