#pragma once

#include <cstdint>

#include "server/robot/robot.h"
#include "server/view/glance.h"

namespace uplink::view {

/// A number that changes with what Queries show of the robot from memory. Two states that differ
/// have the same one by chance alone. It is taken of every robot again and again: it copies no live
/// part, and takes some locks one after the other, each for a moment.
///
/// Thread: any.
[[nodiscard]] std::uint64_t MarkOf(const robot::Robot& robot, const LiveSources& sources);

}  // namespace uplink::view
