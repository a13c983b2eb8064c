#pragma once

#include <vector>

#include "tools/uplink-fleet/report/run_figures.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// Adds to the figures what the robots counted, each for itself and all together.
void SumUp(const std::vector<RobotOutcome>& robots, Shared& shared, RunFigures& figures);

/// Streams were broken or refused on the way, so that frames may have been lost and sent again.
[[nodiscard]] bool WasDisturbed(const RunFigures& figures);

}  // namespace uplink::synthetic
