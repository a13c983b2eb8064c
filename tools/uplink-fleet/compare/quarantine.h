#pragma once

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {

/// The quarantine of this session against the messages that were wrong on purpose: each acked one
/// has its row, and its Reject came before the Ack. Pure; any thread.
void CompareQuarantine(const RobotOutcome& robot, const StoredRobot& stored, Findings& findings);

}  // namespace uplink::synthetic
