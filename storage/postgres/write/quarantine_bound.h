#pragma once

#include <functional>
#include <span>
#include <string>

#include <absl/status/statusor.h>

#include "storage/postgres/link/connection.h"
#include "storage/retention.h"

namespace uplink::storage::postgres {

/// Store::TrimQuarantine in one transaction. `before_commit` as BatchCommit's.
[[nodiscard]] absl::StatusOr<Trimmed> TrimQuarantine(
    Connection& connection, std::span<const std::string> ruris,
    const std::function<absl::Status()>& before_commit);

}  // namespace uplink::storage::postgres
