#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/uplink-fleet/twin/account.h"
#include "uplink/v1/fleet.pb.h"

/// What the server and its store showed at the end of a run.
namespace uplink::synthetic {

/// A span of the server's clock.
struct Span {
  std::int64_t from_ms = 0;
  std::int64_t to_ms = 0;
};

/// Of one robot. Histories hold what arrived since the run began. A value.
struct StoredRobot {
  std::vector<v1::Fault> faults;
  std::vector<v1::Fault> active_faults;
  std::vector<v1::Event> events;
  std::vector<v1::RobotMessage> messages;
  std::vector<v1::MissionRun> runs;
  std::vector<v1::Shape> shapes;
  std::vector<v1::TrackedObject> objects;
  std::vector<v1::PresenceChange> presence;
  std::vector<v1::Quarantined> quarantine;
  /// Rows of quarantine that went for the robot's bound.
  std::int64_t quarantine_dropped = 0;
  std::vector<v1::Gap> gaps;
  /// The server's clock around the reading of shapes and objects: what expired before the first was
  /// gone, what expires after the second was there.
  Span read;
};

/// Of a twin. A value.
struct StoredTwin {
  /// Rows of its two robots, by Side.
  std::array<StoredRobot, kSides> robots;
  /// Of its environment and its workflow run.
  std::vector<v1::ScopeUpdate> scopes;

  [[nodiscard]] const StoredRobot& Of(Side side) const {
    return robots.at(static_cast<std::size_t>(side));
  }
};

/// Of a drone. A value.
struct StoredDrone {
  StoredRobot robot;
  std::vector<v1::OperatorRequest> requests;
};

/// `GET /api/v1/robots/{ruri}` of its two robots while the link was quiet, by Side, as the server
/// wrote it; empty: no such robot.
using TwinLook = std::array<std::string, kSides>;

}  // namespace uplink::synthetic
