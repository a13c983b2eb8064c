#pragma once

#include <absl/status/statusor.h>

#include "storage/claim.h"
#include "storage/identity.h"

namespace uplink::storage::sqlite {

struct Tables;

/// Store::ClaimDrones for one drone, within the caller's transaction.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
[[nodiscard]] absl::StatusOr<ClaimResult> ClaimDrone(Tables& tables, const ClaimRequest& request,
                                                     const ProcessId& process);

}  // namespace uplink::storage::sqlite
