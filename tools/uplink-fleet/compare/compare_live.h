#pragma once

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/robot/account.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// One robot's account against the live and latest parts that the server showed while the robot was
/// still connected; null: it was not listed. Pure; any thread.
void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

}  // namespace uplink::synthetic
