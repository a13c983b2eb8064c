#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/robot/account.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// Whether the server shows as many robots online and connected as there are. A robot whose
/// connection has just ended for its age is neither for a moment. Pure; any thread.
[[nodiscard]] bool AllThere(const std::map<std::string, v1::Robot>& live, std::size_t robots);

/// One robot's account against the live and latest parts that the server showed while the robot was
/// still connected; null: it was not listed. Pure; any thread.
void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings);

}  // namespace uplink::synthetic
