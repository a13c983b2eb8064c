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

/// Tracks which robots this process holds, by the store's answers: lets changes of presence of held
/// robots be written, drops those of others, and tells the robots.
///
/// Thread: confined to the writer.
class Holds final {
 public:
  explicit Holds(const WriterContext& context) : context_(context) {}

  /// The result of Begin for the client.
  struct BeginResult {
    /// It was not already held since then.
    bool begun = false;
    /// Another process held it in between: its sessions are forgotten.
    bool interrupted = false;
    /// The stream to wake then.
    loop::StreamRef stream;
  };
  /// The store answered that the robot is ours.
  BeginResult Begin(robot::CommitClient& client, const storage::RobotRef& robot,
                    const robot::HoldNews& news);
  /// This process does not hold the robot: another one does, or the store lost it. Returns the
  /// stream to wake.
  loop::StreamRef Lose(robot::CommitClient& client, const storage::RobotRef& robot);
  /// As Lose, for a hold that began then; no effect if the robot is held since later, or not at
  /// all.
  loop::StreamRef LoseSince(const std::string& ruri, storage::Epoch since);
  /// The store holds the robot for us, and has less of it than it confirmed. Returns the stream to
  /// wake.
  loop::StreamRef WentBack(const std::string& ruri);
  /// The store has this presence of the robot. True if that differs from what it confirmed: what
  /// this process last judged is then written again.
  bool FollowPresence(const std::string& ruri, const std::optional<storage::StoredPresence>& stored,
                      Reconnected to);
  /// What the store has confirmed of the held robots, sorted by RURI.
  [[nodiscard]] std::vector<storage::ToldRobot> ToldOfAll() const;

  [[nodiscard]] const HeldRobots& robots() const { return robots_; }

 private:
  const WriterContext context_;
  HeldRobots robots_;
  /// The held robots, by RURI. It owns them: a broker's stand-in has no other owner once its stream
  /// is closed. A robot of the fleet is let go of first (Adopting::LetLeave).
  struct Held {
    robot::ClientRef client;
    storage::RobotRef robot;
  };
  std::unordered_map<std::string, Held> held_;
};

}  // namespace uplink::journal
