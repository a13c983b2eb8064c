#pragma once

#include "metrics/exposition.h"
#include "server/fleet/fleet.h"

namespace uplink::fleet {

/// How many robots there are, for a page of metrics. Any thread.
void AddSamples(const Fleet& fleet, metrics::Exposition& page);

}  // namespace uplink::fleet
