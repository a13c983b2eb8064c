#pragma once

#include <cstddef>

#include "server/robot/live_parts.h"

namespace uplink::view {

/// About how many bytes a copy of the parts holds: of keyed ones, of a status and of joints. Pure;
/// any thread.
[[nodiscard]] std::size_t KeyedBytes(const robot::LiveParts& parts);

}  // namespace uplink::view
