#pragma once

#include "metrics/exposition.h"
#include "schema/base/clock.h"
#include "server/journal/limits.h"
#include "server/journal/probe.h"
#include "server/journal/shards.h"

namespace uplink::journal {

/// What the journals hold now beside what they may (`limits`: of all together), each shard by
/// itself as well, and what their writers counted, for a page of metrics. Any thread.
void AddSamples(const Shards& journals, const JournalLimits& limits, SteadyTime now,
                metrics::Exposition& page);
void AddSamples(const JournalProbe& probe, metrics::Exposition& page);

}  // namespace uplink::journal
