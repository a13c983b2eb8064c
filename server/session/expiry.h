#pragma once

#include "schema/base/clock.h"
#include "schema/model/record.h"

namespace uplink::session {

/// Whether it is an upsert of a shape or an object whose expiry has passed at `now`: such a message
/// is neither stored nor forwarded. Pure.
[[nodiscard]] bool ExpiredOnArrival(const model::Body& body, SystemTime now);

}  // namespace uplink::session
