#include "server/fleet/checkpoint.h"

#include <algorithm>

#include "server/robot/live_bytes.h"

namespace uplink::fleet {
namespace {

void CountAsChanged(robot::Robot& robot, const storage::LiveRow& row) {
  robot::LivePartSet changed;
  for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
    changed.set(kind, row.parts[kind].has_value());
  }
  robot.state.PutBackChanges(changed);
  if (row.session) robot.sessions.PutBackSettled();
}

}  // namespace

void Checkpoint::BeginRound() {
  left_.clear();
  round_bytes_ = 0;
  left_ = sources_.fleet.All();
  if (left_.empty()) return;
  const auto first = static_cast<std::ptrdiff_t>(looked_at_ % left_.size());
  std::rotate(left_.begin(), left_.begin() + first, left_.end());
  std::ranges::reverse(left_);
}

std::vector<storage::LiveRow> Checkpoint::TakeChanged(std::size_t rows_max) {
  std::vector<storage::LiveRow> rows;
  std::size_t bytes = 0;
  while (!left_.empty() && rows.size() < rows_max && bytes < storage::kCheckpointBytesMax &&
         round_bytes_ < kCheckpointRoundBytesMax) {
    const RobotPtr robot = std::move(left_.back());
    left_.pop_back();
    ++looked_at_;
    if (!sources_.writes(robot->ruri())) continue;
    // Read before the changes are taken: changes under another hold are not written under this one.
    const storage::Epoch held_since = robot->state.held_since();
    // The store refuses the row before it has said who holds the robot.
    if (held_since == 0) continue;
    const std::optional<robot::LiveChanges> changes = robot->state.TakeChanges();
    const std::optional<storage::SettledSession> settled = robot->sessions.TakeSettled();
    if (!changes && !settled) continue;
    rows.push_back(robot::ToRow(robot->ruri(), changes ? *changes : robot::LiveChanges()));
    rows.back().session = settled;
    rows.back().held_since = held_since;
    bytes += storage::BytesOf(rows.back());
    round_bytes_ += storage::BytesOf(rows.back());
  }
  return rows;
}

void Checkpoint::PutBack(std::span<const storage::LiveRow> rows) {
  for (const storage::LiveRow& row : rows) {
    if (const RobotPtr robot = sources_.fleet.Find(row.ruri)) CountAsChanged(*robot, row);
  }
}

void Checkpoint::PassedOver(const storage::LiveRow& row) {
  const RobotPtr robot = sources_.fleet.Find(row.ruri);
  // With a stream here, it is ours once the store has opened that. Otherwise it went elsewhere.
  if (robot != nullptr && robot->sessions.View().connected) CountAsChanged(*robot, row);
}

}  // namespace uplink::fleet
