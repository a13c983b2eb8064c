#pragma once

#include "metrics/exposition.h"
#include "server/view/watch_probe.h"

namespace uplink::view {

void AddSamples(const WatchProbe& probe, metrics::Exposition& page);

}  // namespace uplink::view
