#pragma once

#include <string>

#include "schema/base/clock.h"
#include "storage/robot_removal.h"

namespace uplink::ctl {

/// Prints that a robot was removed just now, and whether the store has it again. If its stream was
/// ended for that, waits two seconds first: an agent comes back within one. Returns the
/// exit code.
[[nodiscard]] int ReportRemoved(storage::RobotRemoval& removal, const std::string& ruri,
                                bool stream_ended, const Clock& clock);

}  // namespace uplink::ctl
