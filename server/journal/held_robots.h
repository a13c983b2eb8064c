#pragma once

#include <unordered_map>

#include "server/journal/entry.h"
#include "server/robot/commit_client.h"
#include "storage/types.h"

namespace uplink::journal {

/// The robots that this process owns in the store, each with the epoch since which it does.
///
/// Limits: one entry per robot (limits.robots_max).
/// Thread: confined to the writer.
class HeldRobots final {
 public:
  /// An OpenStream answered that the robot is ours since `since`. False if another process owned
  /// it after our last OpenStream.
  [[nodiscard]] bool Hold(robot::CommitClient& client, storage::Epoch since);
  /// Another process owns it.
  void Lose(robot::CommitClient& client) { since_.erase(&client); }

  /// A robot's first OpenStream goes before its first records; what is void is only dropped.
  [[nodiscard]] bool MayCommit(const Origin& origin) const {
    return since_.contains(origin.client) || origin.IsVoid();
  }
  /// Of a robot that is owned.
  [[nodiscard]] storage::Epoch Since(robot::CommitClient& client) const {
    return since_.at(&client);
  }

 private:
  std::unordered_map<robot::CommitClient*, storage::Epoch> since_;
};

}  // namespace uplink::journal
