#pragma once

#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/compare.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// Store::Compare, in one round trip, for this process.
[[nodiscard]] absl::StatusOr<std::vector<FoundRobot>> CompareAll(Connection& connection,
                                                                 std::span<const ToldRobot> robots,
                                                                 const ProcessId& process);

}  // namespace uplink::storage::postgres
