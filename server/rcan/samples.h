#pragma once

#include <cstddef>

#include "metrics/exposition.h"
#include "server/rcan/probe.h"

namespace uplink::rcan {

/// Adds the counts of the robots' scrapes, and rcan.series_max, to a page of metrics. Any thread.
void AddSamples(const RcanProbe& probe, std::size_t series_max, metrics::Exposition& page);

}  // namespace uplink::rcan
