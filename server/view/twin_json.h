#pragma once

#include <boost/json.hpp>

#include "server/cyberwave/twin_parts.h"

namespace uplink::view {

/// What is known of one robot of a twin, as `Robot.cyberwave`: the vendor's names for what the
/// vendor's messages say, and `receivedAtMs` by the server's clock beside them. A part that was
/// never said is absent. Pure.
[[nodiscard]] boost::json::object TwinJson(const cyberwave::TwinParts& parts);

}  // namespace uplink::view
