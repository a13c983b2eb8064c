#pragma once

#include "metrics/exposition.h"
#include "server/session/probe.h"
#include "server/transport/probe.h"

namespace uplink::transport {

/// What the relay counts, for a page of metrics. Some streams are refused by it, others by their
/// session. Any thread.
void AddSamples(const RelayProbe& probe, const session::SessionProbe& sessions,
                metrics::Exposition& page);

}  // namespace uplink::transport
