#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/bounds.h"
#include "storage/postgres/link/connection.h"
#include "storage/retention.h"
#include "storage/store_rules.h"

// What keeps a store to its bounds and ages, but for histories (retain.h). `before_commit`: as in
// RunAndCommitFor.
namespace uplink::storage::postgres {

/// Closes the open runs over kOpenRunsPerRobotMax of each robot, those that were reported least
/// recently, at most kSweepRowsMax of each; after the reports are written. `robots`: when each
/// reported. What it wrote is how many.
[[nodiscard]] StoreCall CloseRunsOver(const std::map<std::string_view, SystemTime>& robots);
/// The place of such a call among `calls`; nothing if there is none.
[[nodiscard]] std::optional<std::size_t> PlaceOfCloseRunsOver(std::span<const StoreCall> calls);

/// Store::CloseRuns by a clock that is vouched for.
[[nodiscard]] absl::StatusOr<std::size_t> CloseOldRuns(
    Connection& connection, SystemTime now, const std::function<absl::Status()>& before_commit);

/// Store::TrimQuarantine in one transaction.
[[nodiscard]] absl::StatusOr<Trimmed> TrimQuarantine(
    Connection& connection, std::span<const std::string> ruris,
    const std::function<absl::Status()>& before_commit);

/// Store::Sweep, in one transaction.
[[nodiscard]] absl::StatusOr<Swept> SweepRows(Connection& connection, SystemTime now,
                                              const StoreRules& rules,
                                              const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
