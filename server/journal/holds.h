#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/journal/held_robots.h"
#include "server/journal/writer_context.h"
#include "server/loop/wake.h"
#include "server/robot/commit_client.h"
#include "storage/compare.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/presence.h"

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
    loop::StreamRef stream;
  };
  /// The store answered that the robot is ours.
  Told Begin(robot::CommitClient& client, const storage::RobotRef& robot,
             const robot::HoldNews& news);
  /// This process does not hold the robot: another one does, or the store lost it. Returns the
  /// stream to wake.
  loop::StreamRef Lose(robot::CommitClient& client, const storage::RobotRef& robot);
  /// The same of a hold that began then; nothing if the robot is held since later, or not at all.
  loop::StreamRef LoseSince(const std::string& ruri, storage::Epoch since);
  /// The store holds the robot for us, and has less of it than it told. Returns the stream to wake.
  loop::StreamRef WentBack(const std::string& ruri);
  /// The store has this of the robot's presence. True if that is not what it told, or was told:
  /// what this process last judged is written again.
  bool FollowPresence(const std::string& ruri, const std::optional<storage::StoredPresence>& stored,
                      Reconnected to);
  /// What the store told of the robots that are held, by RURI.
  [[nodiscard]] std::vector<storage::ToldRobot> ToldOfAll() const;

  [[nodiscard]] const HeldRobots& robots() const { return robots_; }

 private:
  const WriterContext context_;
  HeldRobots robots_;
  /// Those that are held, by RURI. It keeps them: a broker's stand-in for no robot has no other
  /// owner once its stream is closed, and a robot of the fleet is let go of first
  /// (Adopting::LetLeave).
  struct Held {
    robot::ClientRef client;
    storage::RobotRef robot;
  };
  std::unordered_map<std::string, Held> held_;
};

}  // namespace uplink::journal
