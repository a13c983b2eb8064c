#pragma once

#include <set>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/run/run_context.h"
#include "tools/uplink-fleet/run/stages.h"

namespace uplink::synthetic {

/// What the robots know at the end of a run.
struct RunOutcome {
  /// Unique to the run.
  std::string id;
  std::vector<RobotOutcome> robots;
  /// Robots whose shapes and objects went to others.
  std::set<std::string> origins;
  LastLook look;
};

/// Reads the server's counters and its rows, robot by robot, and compares them with the outcome;
/// what was read before the run is there already.
///
/// Errors: ServerView's; kCancelled when a signal comes.
[[nodiscard]] absl::Status Gather(const RunContext& run, const RunOutcome& outcome,
                                  Evidence& evidence);

}  // namespace uplink::synthetic
