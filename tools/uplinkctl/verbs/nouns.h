#pragma once

#include "server/config/flags.h"

namespace uplink::ctl {

/// Adds every noun whose verbs ask a server: status, fleets, robots, faults, missions and so on.
void AddQuestions(config::Flags& program);

}  // namespace uplink::ctl
