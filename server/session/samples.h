#pragma once

#include "metrics/exposition.h"
#include "server/session/probe.h"

namespace uplink::session {

/// What the sessions count, for a page of metrics. Any thread.
void AddSamples(const SessionProbe& probe, metrics::Exposition& page);

}  // namespace uplink::session
