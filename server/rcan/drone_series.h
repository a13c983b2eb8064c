#pragma once

#include "metrics/rcan/page.h"
#include "schema/base/clock.h"
#include "server/uncrew/live_samples.h"

namespace uplink::rcan {

/// Adds the values of a drone that no stream of the robot said: of each type whose last sample came
/// at most `stale_after` (uncrew.stale_after) before `now`. Called under the drone's lock.
void AddDrone(const uncrew::LiveSamples& live, SteadyTime now, milliseconds stale_after,
              metrics::rcan::SeriesPage& page);

}  // namespace uplink::rcan
