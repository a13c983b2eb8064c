#pragma once

#include "metrics/exposition.h"
#include "server/session/probe.h"
#include "server/transport/probe.h"

namespace uplink::session {

/// What the sessions count, for a page of metrics. Any thread.
void AddSamples(const SessionProbe& probe, metrics::Exposition& page);

/// What the listener for robots counts. Some streams are refused by it, others by their session.
/// Any thread.
void AddSamples(const transport::RelayProbe& probe, const SessionProbe& sessions,
                metrics::Exposition& page);

}  // namespace uplink::session
