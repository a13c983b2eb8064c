#pragma once

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {

/// The mission runs of this robot against what its reports must have become. Pure; any thread.
void CompareMissionRuns(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings);

}  // namespace uplink::synthetic
