#pragma once

#include <string>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {

/// One robot's account against the rows of the store: nothing acked is missing, nothing is double,
/// the contents are equal; and what is present, active, in quarantine. `run` is the id of the run.
/// Pure; any thread.
void CompareRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                 Findings& findings);

}  // namespace uplink::synthetic
