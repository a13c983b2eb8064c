#pragma once

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
  /// Another process holds the robot. Returns the stream to wake.
  robot::StreamRef Lose(robot::CommitClient& client, const storage::RobotRef& robot);

  [[nodiscard]] const HeldRobots& robots() const { return robots_; }

 private:
  const WriterContext context_;
  HeldRobots robots_;
};

}  // namespace uplink::journal
