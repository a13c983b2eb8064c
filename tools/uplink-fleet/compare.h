#pragma once

#include <cstdint>

#include "tools/uplink-fleet/findings.h"
#include "tools/uplink-fleet/ledger.h"
#include "tools/uplink-fleet/stored_robot.h"
#include "uplink/v1/fleet.pb.h"

/// One robot's ledger against what the server shows of it. Pure; any thread.
namespace uplink::synthetic {

/// The rows of the store: nothing acked is missing, nothing is double, the contents are equal; and
/// what is present, active, in quarantine.
void CompareRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                 Findings& findings);

/// The robot as the server showed it while it was still connected; null: it was not listed.
void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

/// The changes of presence up to `until_ms` (the server's clock, while the robot was connected):
/// the latest is online, and the robot was called offline at most as often as it was silent itself.
void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, std::int64_t until_ms,
                     Findings& findings);

}  // namespace uplink::synthetic
