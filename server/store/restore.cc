#include "server/store/restore.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "server/robot/live_bytes.h"
#include "server/store/reported.h"

namespace uplink::store {

bool Restore::due() const {
  return std::ranges::any_of(
      fleet_.All(), [](const fleet::RobotPtr& robot) { return robot->state.needs_restore(); });
}

std::vector<fleet::RobotPtr> Restore::Due() const {
  std::vector<fleet::RobotPtr> robots = fleet_.Sorted();
  std::erase_if(robots, [](const fleet::RobotPtr& robot) { return !robot->state.needs_restore(); });
  return robots;
}

absl::Status Restore::Run() {
  left_out_ = 0;
  const std::vector<fleet::RobotPtr> due = Due();
  std::span<const fleet::RobotPtr> left = due;
  while (!left.empty()) {
    const auto restored = RestoreFirst(left.first(std::min(left.size(), kRestoredAtOnceMax)));
    if (!restored.ok()) return restored.status();
    left = left.subspan(*restored);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::size_t> Restore::RestoreFirst(std::span<const fleet::RobotPtr> robots) {
  std::vector<std::string> ruris;
  std::map<std::string, storage::Epoch> holds;
  for (const fleet::RobotPtr& robot : robots) {
    ruris.push_back(robot->ruri());
    // Before the read, which then shows this hold or a later one. A hold that was lost meanwhile
    // takes nothing.
    holds[robot->ruri()] = robot->state.held_since();
  }
  const auto live = reader_.LiveOf(ruris);
  if (!live.ok()) return live.status();
  auto reported = ReadReported(std::span(ruris).first(live->complete), reader_);
  if (!reported.ok()) return reported.status();
  schema::Judge judge(robot::JudgeLimitsOfLive());
  for (const storage::LiveRow& row : live->rows) {
    robot::LiveRead read = robot::FromRow(row, judge);
    left_out_ += read.left_out;
    fleet_.Find(row.ruri)->state.Restore(std::move(read.before), holds[row.ruri]);
  }
  for (auto& [ruri, before] : *reported) {
    const auto hold = holds.find(ruri);
    if (hold != holds.end()) fleet_.Find(ruri)->state.Restore(std::move(before), hold->second);
  }
  for (const fleet::RobotPtr& robot : robots.first(live->complete)) {
    robot->state.SetRestored(holds[robot->ruri()]);
  }
  return live->complete;
}

}  // namespace uplink::store
