#pragma once

#include <cstddef>

#include "schema/base/clock.h"
#include "server/journal/journal.h"
#include "server/robot/held_back.h"
#include "server/robot/robot_sessions.h"
#include "server/session/limits.h"
#include "server/session/throttle.h"

namespace uplink::session {

using robot::HeldBack;

/// What decides whether a stream is held back. All of it outlives the look.
struct HeldBackSources {
  const robot::RobotSessions& sessions;
  const journal::Journal& journal;
  const Throttle& throttle;
  const SessionLimits& limits;
  const Clock& clock;
};

/// Whether a message may be processed now, and what keeps it if not: the first that applies, in the
/// order of the enumeration. `outgoing` is the number of frames that wait for the peer. What it
/// says can change at once: other threads commit and fill the journal.
[[nodiscard]] HeldBack HeldBackBy(const HeldBackSources& sources, std::size_t outgoing);

}  // namespace uplink::session
