#pragma once

#include <cstddef>

#include "metrics/exposition.h"
#include "server/rcan/probe.h"

namespace uplink::rcan {

/// What the robots' scrapes count, beside rcan.series_max, for a page of metrics. Any thread.
void AddSamples(const RcanProbe& probe, std::size_t series_max, metrics::Exposition& page);

}  // namespace uplink::rcan
