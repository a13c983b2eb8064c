#pragma once

#include <string>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {

/// The active faults of this run against the raises that the robot has not cleared, and when each
/// was raised. Pure; any thread.
void CompareActiveFaults(const RobotOutcome& robot, const StoredRobot& stored,
                         const std::string& run, Findings& findings);

}  // namespace uplink::synthetic
