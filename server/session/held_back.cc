#include "server/session/held_back.h"

#include <algorithm>

#include "schema/model/held_bytes.h"

namespace uplink::session {

Hold HoldOfAll(const HeldBackSources& sources, std::size_t outgoing) {
  if (outgoing >= kOutgoingFramesMax) return {.by = HeldBack::kUnread};
  const std::optional<SteadyTime> throttled = sources.robot.throttle.end();
  if (throttled && sources.clock.Steady() < *throttled) {
    return {.by = HeldBack::kMalformed, .until = throttled};
  }
  const std::optional<SteadyTime> limited = sources.robot.limited_throttle.end();
  if (limited && sources.clock.Steady() < *limited) {
    return {.by = HeldBack::kFlow, .until = limited};
  }
  return {};
}

std::size_t FlowBytes(std::size_t payload_bytes, const model::Record& record) {
  return std::max(payload_bytes, model::HeldBytes(record));
}

Hold HoldOfRecord(const HeldBackSources& sources, const RecordCost& cost) {
  const robot::JournalUse use = sources.robot.sessions.journal_use();
  if (use.records >= sources.limits.in_flight_uplinks_max) return {.by = HeldBack::kInFlight};
  switch (sources.journal.RoomFor(use, cost.journal_bytes, sources.gateway)) {
    case journal::Room::kShareFull:
      return {.by = HeldBack::kJournalShare};
    case journal::Room::kFull:
      return {.by = HeldBack::kJournal};
    case journal::Room::kFree:
      break;
  }
  const SteadyTime now = sources.clock.Steady();
  const robot::DurableFlow::Answer flow =
      cost.flow_bytes ? sources.robot.flow.LookAt(*cost.flow_bytes, sources.flow, now)
                      : sources.robot.flow.LookAtDisk(now);
  if (flow.by == HeldBack::kNone) return {};
  return {.by = flow.by, .until = flow.again};
}

}  // namespace uplink::session
