#pragma once

#include <string>
#include <unordered_map>

#include "server/journal/held_robots.h"
#include "server/journal/writer_context.h"
#include "server/robot/commit_client.h"
#include "server/robot/wake.h"
#include "storage/types.h"

namespace uplink::journal {

/// Follows what the store says of who holds a robot: keeps the account, lets its changes of
/// presence go or drops them, and tells the robot.
///
/// Thread: confined to the writer.
class Holds final {
 public:
  explicit Holds(const WriterContext& context) : context_(context) {}

  /// Whose robot it is, and what that means for its client.
  struct Told {
    /// It was not held since then before.
    bool begun = false;
    /// Another process held it after this one did last: its sessions are forgotten.
    bool interrupted = false;
    /// To wake then.
    robot::StreamRef stream;
  };
  /// The store answered that the robot is ours.
  Told Begin(robot::CommitClient& client, const storage::RobotRef& robot,
             const robot::HoldNews& news);
  /// This process does not hold the robot: another one does, or the store lost it. Returns the
  /// stream to wake.
  robot::StreamRef Lose(robot::CommitClient& client, const storage::RobotRef& robot);
  /// The same of a hold that began then; nothing if the robot is held since later, or not at all.
  robot::StreamRef LoseSince(const storage::RobotRef& robot, storage::Epoch since);

  [[nodiscard]] const HeldRobots& robots() const { return robots_; }

 private:
  const WriterContext context_;
  HeldRobots robots_;
  /// Those that are held, by RURI. A robot leaves memory only when it is not (Adopting::LetLeave).
  std::unordered_map<std::string, robot::CommitClient*> clients_;
};

}  // namespace uplink::journal
