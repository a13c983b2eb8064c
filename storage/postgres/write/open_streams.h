#pragma once

#include <functional>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/identity.h"
#include "storage/open_stream.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// Store::OpenStreams in one transaction; one round trip unless a robot is named more than once.
[[nodiscard]] absl::StatusOr<std::vector<OpenResult>> OpenAll(
    Connection& connection, std::span<const OpenRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
