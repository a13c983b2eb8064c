#pragma once

#include "metrics/exposition.h"
#include "server/relay/server.h"
#include "server/session/probe.h"

namespace uplink {

/// What the relay counts, for a page of metrics. Any thread.
void AddRelaySamples(const relay::RelayProbe& probe, const session::SessionProbe& sessions,
                     const metrics::Cell& handshakes_failed, metrics::Exposition& page);

}  // namespace uplink
