#pragma once

#include <string>

#include "schema/base/clock.h"
#include "storage/robot_removal.h"

namespace uplink::ctl {

/// Tells that a robot was removed just now, and whether the store has it again. If its stream was
/// ended for that, two seconds are waited: an agent comes back after one or sooner. Returns the
/// exit code.
[[nodiscard]] int TellRemoved(storage::RobotRemoval& removal, const std::string& ruri,
                              bool stream_ended, const Clock& clock);

}  // namespace uplink::ctl
