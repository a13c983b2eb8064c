#pragma once

#include <cstdint>
#include <vector>

#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// What the server and its store showed of one robot at the end. Histories hold what arrived since
/// the run began. A value.
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
  std::int64_t read_from_ms = 0;
  std::int64_t read_to_ms = 0;
};

}  // namespace uplink::synthetic
