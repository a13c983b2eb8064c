#pragma once

#include <cstddef>

#include "server/cyberwave/twins.h"
#include "server/view/queries.h"

namespace uplink::view {

/// What a byte of a twin becomes in an answer at most, about: many small values, each a node of a
/// tree of JSON and of a Struct (measured with lists of empty lists: 600 MB for 11 MB of text).
inline constexpr std::size_t kTwinAnswerFactor = 16;

/// Adds to a robot what its twin said, unless it is none that was heard or another process holds
/// it. Null `twins`: nothing is heard. Returns about how many bytes the answer takes. Any thread.
std::size_t CopyTwin(const cyberwave::Twins* twins, RobotView& robot);

}  // namespace uplink::view
