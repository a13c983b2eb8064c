#pragma once

#include <functional>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/claim.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// Store::ClaimDrones, in one round trip. Locks what every transaction does, robots in order of
/// their keys, before anything of a claim is read or written. `before_commit` as BatchCommit's.
///
/// Errors: as Store::ClaimDrones.
[[nodiscard]] absl::StatusOr<std::vector<ClaimResult>> ClaimAll(
    Connection& connection, std::span<const ClaimRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
