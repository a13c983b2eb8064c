#include "server/store/seed.h"

namespace uplink::store {

absl::Status Seed::Run(std::size_t robots_max) {
  const auto rows = context_.reader.Robots(static_cast<std::uint32_t>(robots_max));
  if (!rows.ok()) return rows.status();
  absl::Status admitted;
  for (const storage::RobotRow& row : *rows) {
    const auto robot = context_.fleet.AdmitNew(row.robot);
    if (!robot.ok()) admitted = robot.status();
    RestoreSession(row);
    // One that has come by itself knows its fleet better than the row.
    if (robot.ok() && *robot != nullptr) Take(**robot, row);
  }
  done_.store(true);
  return admitted;
}

void Seed::RestoreSession(const storage::RobotRow& row) const {
  robot::Robot* robot = context_.fleet.Find(row.robot.ruri);
  if (robot == nullptr || !row.last_session) return;
  robot->sessions.Restore(*row.last_session);
}

void Seed::Take(robot::Robot& robot, const storage::RobotRow& row) const {
  robot.state.FollowHolder(
      {}, row.last_presence ? storage::StoredPresence{*row.last_presence, row.presence_since}
                            : storage::StoredPresence{model::Presence::kUnknown, row.first_seen});
  if (!context_.adopt_grace) return;
  context_.journals.Adopt(
      {.client = &robot,
       .request = {.robot = robot.id(), .holder = row.holder},
       .grace = {.ended = *context_.adopt_grace, .silent = *context_.adopt_grace}});
}

}  // namespace uplink::store
