#pragma once

#include "metrics/exposition.h"
#include "server/log/logger.h"

namespace uplink::log {

/// Adds how many lines wait and how many were lost to a page of metrics. Any thread.
void AddSamples(const Logger& logger, metrics::Exposition& page);

}  // namespace uplink::log
