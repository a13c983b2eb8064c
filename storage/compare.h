#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "schema/model/ids.h"
#include "storage/epoch.h"
#include "storage/presence.h"

// What a process knows from a store, and whether the store still has it: after a reconnect it may
// be another store, which lacks the last commits (Store::InDoubt).
namespace uplink::storage {

/// Robots of one call of Store::Compare: some milliseconds of reading.
inline constexpr std::size_t kComparedMax = 1'000;

/// How far a store said that a session is committed. A value.
struct CommittedSession {
  model::SessionId session;
  model::Seq cursor = 0;

  friend bool operator==(const CommittedSession&, const CommittedSession&) = default;
};

/// What a store told a process of a robot that it holds. A value.
struct ToldRobot {
  std::string ruri;
  Epoch held_since = 0;
  /// At most kSessionsPerRobotMax.
  std::vector<CommittedSession> sessions;
};

/// What the store has of it. A value.
struct FoundRobot {
  /// This process holds the robot since then.
  bool held = false;
  /// The store has less than it told: an older hold, or, unless somebody has held the robot since,
  /// a cursor below the one it said.
  bool went_back = false;
  /// As OpenResult's; nothing of a robot that is not held.
  std::optional<StoredPresence> presence;

  friend bool operator==(const FoundRobot&, const FoundRobot&) = default;
};

}  // namespace uplink::storage
