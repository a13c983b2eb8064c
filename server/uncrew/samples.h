#pragma once

#include "metrics/exposition.h"
#include "schema/base/clock.h"
#include "server/uncrew/drones.h"
#include "server/uncrew/probe.h"

namespace uplink::uncrew {

/// Adds counts of drones' calls, and of requests that wait for operators at `now`.
void AddSamples(const Drones& drones, const AvatarProbe& probe, SteadyTime now,
                metrics::Exposition& page);

}  // namespace uplink::uncrew
