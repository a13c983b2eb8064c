#pragma once

#include <functional>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/adopt.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// Store::Adopt, in one round trip. `before_commit` as BatchCommit's.
///
/// Errors: as Store::Adopt.
[[nodiscard]] absl::StatusOr<std::vector<AdoptResult>> AdoptAll(
    Connection& connection, std::span<const AdoptRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
