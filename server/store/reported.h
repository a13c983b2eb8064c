#pragma once

#include <map>
#include <span>
#include <string>

#include <absl/status/statusor.h>

#include "server/robot/robot_state.h"
#include "storage/reader.h"

namespace uplink::store {

/// What the stored durable reports of these robots say now, by RURI, for their series. Robots
/// without a stored report are left out.
///
/// Errors: of the reader.
[[nodiscard]] absl::StatusOr<std::map<std::string, robot::Reported>> ReadReported(
    std::span<const std::string> ruris, storage::Reader& reader);

}  // namespace uplink::store
