#pragma once

#include "metrics/exposition.h"
#include "server/http/limits.h"
#include "server/http/probe.h"

namespace uplink::http {

/// What HTTP counts beside its bounds, for a page of metrics. Any thread.
void AddSamples(const HttpProbe& probe, const ConnectionsMax& connections_max,
                metrics::Exposition& page);

}  // namespace uplink::http
