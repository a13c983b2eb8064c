#pragma once

#include <cstdint>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/ledger.h"
#include "uplink/v1/fleet.pb.h"

/// One robot's ledger against what the server shows of it. Pure; any thread.
namespace uplink::synthetic {

/// The rows of the store: nothing acked is missing, nothing is double, the contents are equal; and
/// what is present, active, in quarantine.
void CompareRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                 Findings& findings);

/// The robot as the server showed it while it was still connected; null: it was not listed.
void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

/// A span of the server's clock.
struct Span {
  std::int64_t from_ms = 0;
  std::int64_t to_ms = 0;
};

/// The changes of presence: the latest up to the span's end, while the robot was connected, is
/// online, and within the span it was called offline at most as often as it was silent itself.
void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, const Span& run,
                     Findings& findings);

}  // namespace uplink::synthetic
