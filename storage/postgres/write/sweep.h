#pragma once

#include <cstddef>
#include <functional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/retention.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

/// Store::Sweep, in one transaction. `before_commit`: as in RunAndCommitFor.
[[nodiscard]] absl::StatusOr<Swept> SweepRows(Connection& connection, SystemTime now,
                                              const StoreRules& rules,
                                              const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
