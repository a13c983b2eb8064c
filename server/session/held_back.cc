#include "server/session/held_back.h"

#include <optional>

namespace uplink::session {

HeldBack HeldBackBy(const HeldBackSources& sources, std::size_t outgoing) {
  if (sources.sessions.in_flight() >= sources.limits.in_flight_uplinks_max)
    return HeldBack::kInFlight;
  if (!sources.journal.HasRoom()) return HeldBack::kJournal;
  if (outgoing >= kOutgoingFramesMax) return HeldBack::kUnread;
  const std::optional<SteadyTime> throttled = sources.throttle.end();
  if (throttled && sources.clock.Steady() < *throttled) return HeldBack::kMalformed;
  return HeldBack::kNone;
}

}  // namespace uplink::session
