#pragma once

#include <cstdint>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_robot.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {

/// A span of the server's clock.
struct Span {
  std::int64_t from_ms = 0;
  std::int64_t to_ms = 0;
};

/// The changes of presence: the latest up to the span's end, while the robot was connected, is
/// online, and within the span it was called offline at most as often as it was silent itself.
/// Pure; any thread.
void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, const Span& run,
                     Findings& findings);

}  // namespace uplink::synthetic
