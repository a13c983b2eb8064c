#pragma once

#include <cstddef>

#include "server/cyberwave/twins.h"
#include "server/view/queries.h"

namespace uplink::view {

/// Adds to a robot what its twin said, unless it is none that was heard or another process holds
/// it. Null `twins`: nothing is heard. Returns about how many bytes the copy takes. Any thread.
std::size_t CopyTwin(const cyberwave::Twins* twins, RobotView& robot);

}  // namespace uplink::view
