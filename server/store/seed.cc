#include "server/store/seed.h"

#include <string>
#include <utility>
#include <vector>

#include "server/robot/live_bytes.h"
#include "server/store/reported.h"

namespace uplink::store {

absl::Status Seed::Run(std::size_t robots_max) {
  const auto rows = reader_.Robots(static_cast<std::uint32_t>(robots_max));
  if (!rows.ok()) return rows.status();
  absl::Status admitted;
  for (const storage::RobotRow& row : *rows) {
    const auto robot = fleet_.AdmitNew(row.robot);
    if (!robot.ok()) admitted = robot.status();
    RestoreSession(row);
    // One that has come by itself knows its fleet better than the row.
    if (!robot.ok() || *robot == nullptr || !row.last_presence) continue;
    journals_.BeginPresence((*robot)->id(), *row.last_presence, clock_.System());
  }
  absl::Status restored = RestoreLive();
  if (restored.ok()) restored = RestoreReported();
  if (!restored.ok()) return restored;
  done_.store(true);
  return admitted;
}

void Seed::RestoreSession(const storage::RobotRow& row) {
  robot::Robot* robot = fleet_.Find(row.robot.ruri);
  if (robot == nullptr || !row.last_session) return;
  robot->sessions.Restore({row.last_session->session, row.last_session->cursor});
}

absl::Status Seed::RestoreLive() {
  schema::Judge judge(robot::JudgeLimitsOfLive());
  live_left_out_ = 0;
  std::string after;
  while (true) {
    const auto rows = reader_.Live(after);
    if (!rows.ok()) return rows.status();
    if (rows->empty()) return absl::OkStatus();
    for (const storage::LiveRow& row : *rows) {
      robot::Robot* robot = fleet_.Find(row.ruri);
      if (robot == nullptr) continue;
      robot::LiveRead read = robot::FromRow(row, judge);
      live_left_out_ += read.left_out;
      robot->state.Restore(std::move(read.before));
    }
    after = rows->back().ruri;
  }
}

absl::Status Seed::RestoreReported() {
  std::vector<std::string> ruris;
  for (const robot::Robot* robot : fleet_.Sorted()) ruris.push_back(robot->ruri());
  auto reported = ReadReported(ruris, reader_);
  if (!reported.ok()) return reported.status();
  for (auto& [ruri, before] : *reported) {
    if (robot::Robot* robot = fleet_.Find(ruri)) robot->state.Restore(std::move(before));
  }
  return absl::OkStatus();
}

}  // namespace uplink::store
