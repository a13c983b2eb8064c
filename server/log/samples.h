#pragma once

#include "metrics/exposition.h"
#include "server/log/logger.h"

namespace uplink::log {

/// What waits to be written and what was lost, for a page of metrics. Any thread.
void AddSamples(const Logger& logger, metrics::Exposition& page);

}  // namespace uplink::log
