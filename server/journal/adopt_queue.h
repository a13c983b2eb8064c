#pragma once

#include <cstddef>
#include <deque>
#include <unordered_set>
#include <vector>

#include "schema/base/clock.h"
#include "server/robot/commit_client.h"
#include "storage/adopt.h"
#include "storage/epoch.h"
#include "storage/identity.h"

namespace uplink::journal {

/// How long an adopted robot may be silent before it counts as offline.
struct AdoptGrace {
  /// presence.startup_grace: no robot streams to a holder that ended.
  milliseconds ended{0};
  /// presence.adopted_grace: the robot may stream to a holder that fell silent.
  milliseconds silent{0};

  [[nodiscard]] milliseconds Of(storage::HolderEnd end) const;
};

/// A robot whose holder is over.
struct AdoptEntry {
  robot::ClientRef client;
  storage::AdoptRequest request;
  AdoptGrace grace;
};

/// A robot that another process holds since an epoch.
struct LossEntry {
  robot::ClientRef client;
  storage::RobotRef robot;
  storage::Epoch since = 0;
};

/// A robot that should leave memory (CommitClient::MayLeave).
struct LeaveEntry {
  robot::ClientRef client;
  storage::RobotRef robot;
};

/// Robots that change hands: those to adopt, those that were lost and those that leave memory, in
/// order, each robot at most once in each queue.
///
/// Limits: three entries per robot in memory (limits.robots_max, and fleet::kLeavingMax).
/// Thread: confined to its owner's lock.
class AdoptQueue final {
 public:
  /// False if the robot already waits to be adopted.
  bool Push(AdoptEntry entry);
  /// False if it already waits to be let go.
  bool Push(LossEntry entry);
  /// False if it already waits to leave.
  bool Push(LeaveEntry entry);

  /// Takes at most `most` from the front. They may be pushed again from now on.
  [[nodiscard]] std::vector<AdoptEntry> TakeAdopts(std::size_t most);
  [[nodiscard]] std::vector<LossEntry> TakeLosses();
  [[nodiscard]] std::vector<LeaveEntry> TakeLeaves();

  [[nodiscard]] bool empty() const { return adopts_.empty() && losses_.empty() && leaves_.empty(); }

 private:
  std::deque<AdoptEntry> adopts_;
  std::unordered_set<robot::CommitClient*> adopting_;
  std::vector<LossEntry> losses_;
  std::unordered_set<robot::CommitClient*> lost_;
  std::vector<LeaveEntry> leaves_;
  std::unordered_set<robot::CommitClient*> leaving_;
};

}  // namespace uplink::journal
