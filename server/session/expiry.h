#pragma once

#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "storage/clock_trust.h"

namespace uplink::session {

/// Whether it is an upsert of a shape or an object whose expiry has passed at `now`: such a message
/// is neither stored nor forwarded. Never while nobody vouches for the clock that says so: the
/// message is stored then.
[[nodiscard]] bool ExpiredOnArrival(const model::Body& body, SystemTime now,
                                    const storage::ClockTrust& clock_trust);

}  // namespace uplink::session
