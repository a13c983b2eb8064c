#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "schema/model/ids.h"

// Who a store knows: robots, and the processes that hold them.
namespace uplink::storage {

/// A robot's identity, shared by all records of the robot. Immutable.
using RobotRef = std::shared_ptr<const model::RobotId>;

/// One life of one server process: 16 random bytes drawn at its start.
using ProcessId = std::array<std::uint8_t, 16>;

/// Stands for the server itself where a session needs a robot. No certificate can name it, since a
/// RURI begins with `rcan://`. Its sessions do not count for kSessionsPerRobotMax, and no list of
/// robots shows it.
inline constexpr std::string_view kServerRuri = "server";

}  // namespace uplink::storage
