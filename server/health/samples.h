#pragma once

#include <string>

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "schema/base/clock.h"
#include "server/health/monitor.h"

namespace uplink::health {

/// Facts about this process that never change. A value.
struct ProcessStart {
  std::string version;
  SystemTime at;
};

// Health's samples for a page of metrics. Any thread.

/// Whether the relay answers, the certificate, the drain, and each word of `degraded`.
void AddSamples(Monitor& monitor, metrics::Exposition& page);
/// How long each sweep of presence took.
void AddSweepSamples(const metrics::LatencyDistribution& sweep_seconds, metrics::Exposition& page);
/// The build, and the process as the kernel sees it now.
void AddProcessSamples(const ProcessStart& start, metrics::Exposition& page);

}  // namespace uplink::health
