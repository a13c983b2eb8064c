#include "server/seed.h"

namespace uplink {

absl::Status Seed::Run(std::size_t robots_max) {
  const auto rows = reader_.Robots(static_cast<std::uint32_t>(robots_max));
  if (!rows.ok()) return rows.status();
  for (const storage::RobotRow& row : *rows) {
    // It has come by itself, and knows its fleet better than the row.
    if (fleet_.Find(row.robot.ruri) != nullptr) continue;
    const auto robot = fleet_.FindOrAdmit(row.robot);
    if (!robot.ok()) {
      done_.store(true);
      return robot.status();
    }
    if (!row.last_presence) continue;
    journals_.BeginPresence((*robot)->id(), *row.last_presence, clock_.System());
  }
  done_.store(true);
  return absl::OkStatus();
}

}  // namespace uplink
