#pragma once

#include <boost/json.hpp>

#include "server/cyberwave/twin_parts.h"

namespace uplink::view {

/// What one twin's messages reported, as `Robot.cyberwave`: by the vendor's names, and
/// `receivedAt` by the server's clock beside them. A part that was never reported is absent.
/// Pure.
[[nodiscard]] boost::json::object TwinJson(const cyberwave::TwinParts& parts);

}  // namespace uplink::view
