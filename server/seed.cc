#include "server/seed.h"

namespace uplink {

absl::Status Seed::Run(std::size_t robots_max) {
  const auto rows = reader_.Robots(static_cast<std::uint32_t>(robots_max));
  if (!rows.ok()) return rows.status();
  for (const storage::RobotRow& row : *rows) {
    const auto robot = fleet_.FindOrAdmit(row.robot);
    if (!robot.ok()) {
      done_.store(true);
      return robot.status();
    }
    const bool is_heard = (*robot)->state.presence() != model::Presence::kUnknown;
    if (!row.last_presence || is_heard) continue;
    journals_.BeginPresence((*robot)->id(), *row.last_presence, clock_.System());
  }
  done_.store(true);
  return absl::OkStatus();
}

}  // namespace uplink
