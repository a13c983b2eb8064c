#pragma once

#include "metrics/rcan/page.h"
#include "schema/base/clock.h"
#include "server/rcan/named_series.h"
#include "server/uncrew/live_samples.h"

namespace uplink::rcan {

/// Adds the values of a drone that no stream of the robot reported: those of each type whose last
/// sample came at most `stale_after` (uncrew.stale_after) before `now`. Call it under the drone's
/// lock.
void AddDroneBasic(const uncrew::LiveSamples& live, SteadyTime now, milliseconds stale_after,
                   metrics::rcan::SeriesPage& page);

/// The same for parts with an id that the drone chose: its winches and its distance sensors.
void AddDroneNamed(const uncrew::LiveSamples& live, SteadyTime now, milliseconds stale_after,
                   NamedSeries& series);

}  // namespace uplink::rcan
