#pragma once

#include <cstddef>

#include "metrics/exposition.h"
#include "server/http/probe.h"

namespace uplink::http {

/// What the HTTP server counts beside its bounds, for a page of metrics. Any thread.
void AddSamples(const HttpProbe& probe, std::size_t connections_max, metrics::Exposition& page);

}  // namespace uplink::http
