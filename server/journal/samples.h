#pragma once

#include "metrics/exposition.h"
#include "schema/base/clock.h"
#include "server/journal/limits.h"
#include "server/journal/probe.h"
#include "server/journal/shards.h"

namespace uplink::journal {

/// Adds to a page of metrics what the journals hold, with their limits (`limits` is for all
/// together) and per shard, and what their writers counted. Any thread.
void AddSamples(const Shards& journals, const JournalLimits& limits, SteadyTime now,
                metrics::Exposition& page);
void AddSamples(const JournalProbe& probe, metrics::Exposition& page);

}  // namespace uplink::journal
