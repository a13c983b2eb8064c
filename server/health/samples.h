#pragma once

#include <string>

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "schema/base/clock.h"
#include "server/health/monitor.h"

namespace uplink::health {

/// What of this process does not change while it lives. A value.
struct ProcessStart {
  std::string version;
  SystemTime at;
};

// What health knows, for a page of metrics. Any thread.

/// Whether the relay answers, the certificate, the drain, and each word of `degraded`.
void AddSamples(Monitor& monitor, metrics::Exposition& page);
/// How long the sweeps of presence took.
void AddSweepSamples(const metrics::LatencyDistribution& sweep_seconds, metrics::Exposition& page);
/// The build, and the process as the kernel sees it now.
void AddProcessSamples(const ProcessStart& start, metrics::Exposition& page);

}  // namespace uplink::health
