#pragma once

#include "metrics/exposition.h"
#include "server/fleet/fleet.h"
#include "server/fleet/live_budget.h"

namespace uplink::fleet {

/// How many robots there are, for a page of metrics. Any thread.
void AddSamples(const Fleet& fleet, metrics::Exposition& page);
/// Memory of live state, and parts that were dropped for lack of it. Any thread.
void AddSamples(const LiveBudget& budget, metrics::Exposition& page);

}  // namespace uplink::fleet
