#pragma once

#include <cstddef>

#include "server/cyberwave/twins.h"
#include "server/view/queries.h"

namespace uplink::view {

/// Adds to a robot what its twin reported, if one was heard and no other process holds the robot.
/// Null `twins`: no broker is read. Returns about how many bytes the copy takes. Any thread.
std::size_t CopyTwin(const cyberwave::Twins* twins, RobotView& robot);

}  // namespace uplink::view
