#include "storage/sqlite/compare.h"

#include "storage/sqlite/deciding_tables.h"

namespace uplink::storage::sqlite {

absl::StatusOr<FoundRobot> CompareWith(DecidingTables& deciding, const ToldRobot& robot,
                                       const ProcessId& process) {
  FoundRobot found;
  const auto hold = deciding.HoldOf(robot.ruri);
  if (!hold.ok()) return hold.status();
  if (*hold) {
    found.held = (*hold)->owner == process && (*hold)->epoch == robot.held_since;
    found.went_back = (*hold)->epoch < robot.held_since;
    if ((*hold)->epoch > robot.held_since) return found;
  }
  for (const CommittedSession& told : robot.sessions) {
    const auto session = deciding.FindSession(robot.ruri, told.session);
    if (!session.ok()) return session.status();
    if ((*session ? (*session)->cursor : 0) < told.cursor) found.went_back = true;
  }
  if (!found.held) return found;
  const auto presence = deciding.Presence(robot.ruri);
  if (!presence.ok()) return presence.status();
  found.presence = *presence;
  return found;
}

}  // namespace uplink::storage::sqlite
