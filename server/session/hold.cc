#include "server/session/hold.h"

#include <optional>

namespace uplink::session {

Hold HoldNow(const HoldSources& sources, std::size_t outgoing) {
  if (sources.sessions.in_flight() >= sources.limits.in_flight_uplinks_max) return Hold::kInFlight;
  if (!sources.journal.HasRoom()) return Hold::kJournal;
  if (outgoing >= kOutgoingFramesMax) return Hold::kOutgoing;
  const std::optional<SteadyTime> throttled = sources.throttle.end();
  if (throttled && sources.clock.Steady() < *throttled) return Hold::kThrottled;
  return Hold::kNone;
}

}  // namespace uplink::session
