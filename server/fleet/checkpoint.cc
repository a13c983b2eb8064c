#include "server/fleet/checkpoint.h"

#include "server/fleet/live_bytes.h"

namespace uplink::fleet {

std::vector<storage::LiveRow> Checkpoint::TakeChanged() {
  if (round_.empty()) {
    round_ = fleet_.All();
    next_ = 0;
  }
  std::vector<storage::LiveRow> rows;
  std::size_t bytes = 0;
  while (next_ < round_.size() && rows.size() < storage::kCheckpointRowsMax &&
         bytes < storage::kCheckpointBytesMax) {
    Robot* robot = round_[next_++];
    if (!writes_(robot->ruri())) continue;
    const std::optional<LiveChanges> changes = robot->state.TakeChanges();
    if (!changes) continue;
    rows.push_back(ToRow(robot->ruri(), *changes));
    bytes += storage::BytesOf(rows.back());
  }
  if (rows.empty()) round_.clear();
  return rows;
}

void Checkpoint::PutBack(std::span<const storage::LiveRow> rows) {
  for (const storage::LiveRow& row : rows) {
    Robot* robot = fleet_.Find(row.ruri);
    if (robot == nullptr) continue;
    LivePartSet changed;
    for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
      changed.set(kind, row.parts[kind].has_value());
    }
    robot->state.PutBackChanges(changed);
  }
}

}  // namespace uplink::fleet
