#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/adopt.h"
#include "storage/compare.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"
#include "storage/presence.h"

namespace uplink::storage::postgres {

/// Reads the last presence of each of `ruris` that the store has. A statement that follows the one
/// which locks the robots' rows: what a former holder committed before is seen.
[[nodiscard]] StoreCall ReadPresenceCall(std::span<const std::string_view> ruris);
/// Tells `take` each robot and its presence in an answer to that.
void TakePresence(const Result& rows,
                  const std::function<void(std::string_view ruri, StoredPresence)>& take);

/// Store::Adopt, in one round trip. `before_commit` as BatchCommit's.
///
/// Errors: as Store::Adopt.
[[nodiscard]] absl::StatusOr<std::vector<AdoptResult>> AdoptAll(
    Connection& connection, std::span<const AdoptRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit);

/// Store::Compare, in one round trip, for this process.
[[nodiscard]] absl::StatusOr<std::vector<FoundRobot>> CompareAll(Connection& connection,
                                                                 std::span<const ToldRobot> robots,
                                                                 const ProcessId& process);

}  // namespace uplink::storage::postgres
