#pragma once

#include <cstdint>
#include <unordered_map>

#include "server/journal/entry.h"
#include "server/robot/commit_client.h"
#include "storage/epoch.h"

namespace uplink::journal {

/// The robots that this process holds in the store, each with the epoch since which it does.
///
/// Limits: one entry per robot in memory (limits.robots_max, and fleet::kLeavingMax).
/// Thread: confined to the writer.
class HeldRobots final {
 public:
  enum class Hold : std::uint8_t {
    /// It was already held since then.
    kSame,
    /// It was not held before.
    kNew,
    /// Another process held it in between, which is news.
    kInterrupted,
  };
  /// The store answered that the robot is ours since `since`.
  Hold Begin(robot::CommitClient& client, storage::Epoch since);
  /// Another process holds it.
  void Lose(robot::CommitClient& client) { since_.erase(&client); }

  /// Whether the entry may go into a batch. A robot's first OpenStream goes before its first
  /// records; void entries are only dropped. A sample needs no hold, since its claim was answered
  /// before.
  [[nodiscard]] bool MayCommit(const Origin& origin) const {
    return origin.is_sample || since_.contains(origin.client.get()) || origin.IsVoid();
  }
  /// 0 if the robot is not held.
  [[nodiscard]] storage::Epoch Since(robot::CommitClient& client) const {
    const auto held = since_.find(&client);
    return held == since_.end() ? 0 : held->second;
  }

 private:
  std::unordered_map<robot::CommitClient*, storage::Epoch> since_;
};

}  // namespace uplink::journal
