#include "tools/uplink-fleet/compare/compare_presence.h"

#include <fmt/core.h>

namespace uplink::synthetic {

void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, const Span& run,
                     Findings& findings) {
  findings.Expect(Thing::kPresenceHistory);
  const v1::PresenceChange* latest = nullptr;
  std::uint64_t offline = 0;
  for (const v1::PresenceChange& change : stored.presence) {
    if (change.at_ms() > run.to_ms) continue;
    if (latest == nullptr) latest = &change;  // the newest comes first
    const bool within = change.at_ms() >= run.from_ms;
    if (within && change.presence() == v1::PRESENCE_OFFLINE) ++offline;
  }
  if (latest == nullptr || latest->presence() != v1::PRESENCE_ONLINE) {
    return findings.Differ(
        Thing::kPresenceHistory, robot.ruri, "online at last",
        latest == nullptr ? "no change at all" : v1::Presence_Name(latest->presence()));
  }
  if (offline > robot.silences) {
    return findings.Differ(Thing::kPresenceHistory, robot.ruri,
                           fmt::format("offline {} times at most", robot.silences),
                           fmt::format("{} times", offline));
  }
  findings.Find(Thing::kPresenceHistory);
}

}  // namespace uplink::synthetic
