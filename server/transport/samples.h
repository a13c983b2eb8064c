#pragma once

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "server/session/probe.h"
#include "server/transport/probe.h"

namespace uplink::transport {

/// What the relay counts, for a page of metrics. Some streams are refused by it, others by their
/// session; gRPC tells of the handshakes that failed. Any thread.
void AddSamples(const RelayProbe& probe, const session::SessionProbe& sessions,
                const metrics::Cell& handshakes_failed, metrics::Exposition& page);

}  // namespace uplink::transport
