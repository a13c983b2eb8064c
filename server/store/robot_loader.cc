#include "server/store/robot_loader.h"

#include <algorithm>

namespace uplink::store {

absl::StatusOr<std::size_t> RobotLoader::Run(std::size_t robots_max) {
  const auto rows = context_.reader.Robots(static_cast<std::uint32_t>(robots_max));
  if (!rows.ok()) return rows.status();
  std::size_t known = rows->size();
  if (known >= robots_max) {
    const auto count = context_.reader.RobotCount();
    if (!count.ok()) return count.status();
    known = std::max(known, *count);
  }
  if (known > rows->size()) {
    if (absl::Status read = KnowOtherFleets(); !read.ok()) return read;
  }
  std::size_t taken = 0;
  for (const storage::RobotRow& row : *rows) {
    context_.fleet.odd_fleets().Know(row.robot.fleet);
    // A robot that the store calls online is taken in and judged before it is forgotten.
    if (row.last_presence != model::Presence::kOnline && context_.is_forgotten(row.last_seen)) {
      --known;
      continue;
    }
    const auto robot = context_.fleet.AdmitNew(row.robot);
    if (!robot.ok()) continue;
    ++taken;
    RestoreSession(row);
    // A robot that came by itself knows its fleet better than the row.
    if (*robot != nullptr) Take(**robot, row);
  }
  context_.fleet.odd_fleets().SetRead();
  done_.store(true);
  return known - taken;
}

absl::Status RobotLoader::KnowOtherFleets() const {
  const auto fleets = context_.reader.FleetsBeyondAscii(kFleetsReadMax);
  if (!fleets.ok()) return fleets.status();
  for (const std::string& fleet : *fleets) context_.fleet.odd_fleets().Know(fleet);
  return absl::OkStatus();
}

void RobotLoader::RestoreSession(const storage::RobotRow& row) const {
  const fleet::RobotPtr robot = context_.fleet.Find(row.robot.ruri);
  if (robot == nullptr || !row.last_session) return;
  robot->sessions.Restore(*row.last_session);
}

void RobotLoader::Take(robot::Robot& robot, const storage::RobotRow& row) const {
  robot.NoteHeard(row.last_seen);
  if (row.was_claimed) robot.calls.NoteSpoken();
  robot.state.FollowHolder(
      {}, row.last_presence
              ? storage::StoredPresence{*row.last_presence, row.presence_since, row.parked_until}
              : storage::StoredPresence{model::Presence::kUnknown, row.first_seen});
  if (!context_.adopt_grace) return;
  context_.journals.Adopt(
      {.client = &robot,
       .request = {.robot = robot.id(), .holder = row.holder},
       .grace = {.ended = *context_.adopt_grace, .silent = *context_.adopt_grace}});
}

}  // namespace uplink::store
