#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/latest_kind.h"
#include "storage/presence.h"
#include "storage/rejects.h"

namespace uplink::storage {

/// Whether the stream that asked for an OpenStream is still there.
enum class StreamState : std::uint8_t { kOpen, kEnded };

/// What happens if a request names another fleet than the store has for the robot.
enum class FleetWord : std::uint8_t {
  /// The robot moves to the fleet: a certificate that names the robot says so.
  kMoves,
  /// The request is refused: a gateway speaks for its whole fleet, and for no other robot.
  kMatches,
};

/// A stream begins: draw the robot's next epoch, read the session's cursor.
struct OpenRequest {
  RobotRef robot;
  model::SessionId session;
  /// Hello.settled_seq: rejected numbers above it are returned.
  model::Seq settled_seq = 0;
  SystemTime at;
  /// Sessions that this process holds in memory; they are not evicted.
  std::vector<model::SessionId> sessions_held;
  /// One that has ended takes its robot from no process that has a lease and did not release it.
  StreamState stream = StreamState::kOpen;
  /// How many rejected numbers are returned at most: 1 or more.
  std::size_t rejects_max = kOpenRejectsMax;
  /// What `robot->fleet` does to a robot that the store has in another fleet.
  FleetWord fleet_word = FleetWord::kMoves;
};

struct OpenResult {
  /// False: the stream had ended, and a process that did not release its lease holds the robot; or
  /// the robot is of another fleet (`other_fleet`). Nothing was written, and nothing else is set.
  bool taken = true;
  /// The fleet in which the store has the robot, if it is another one and the request was refused
  /// for that (FleetWord::kMatches).
  std::optional<std::string> other_fleet;
  /// In which fleet the store had the robot, where this moved it to another.
  std::optional<std::string> moved_from;
  /// The store had a row of the robot before.
  bool was_known = false;
  /// The epoch of this stream.
  Epoch epoch = 0;
  /// The epoch since which this process holds the robot without interruption. If it differs from
  /// the one of this process's last OpenStream of the robot, another process had it in between.
  Epoch held_since = 0;
  /// Highest committed durable number of the session; 0 if the store does not know the session.
  model::Seq cursor = 0;
  /// Quarantined numbers in (settled_seq, cursor], ascending: the first rejects_max.
  std::vector<StoredReject> rejects;
  /// How many there are, counted up to kQuarantineRowsPerRobotMax.
  std::size_t rejects_total = 0;
  /// Nothing if the store has no change of the robot's presence.
  std::optional<StoredPresence> presence;
  /// The kinds whose latest message of the robot the store has, from any process.
  LatestKindSet latest_kinds = 0;
};

}  // namespace uplink::storage
