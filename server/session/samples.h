#pragma once

#include "metrics/exposition.h"
#include "server/session/probe.h"
#include "server/transport/probe.h"

namespace uplink::session {

/// Adds the counts of sessions to a page of metrics. Any thread.
void AddSamples(const SessionProbe& probe, metrics::Exposition& page);

/// Adds the counts of the robots' listener, which refuses some streams itself. Certificates that
/// may not come in count at the operators' listener as well. Any thread.
void AddSamples(const transport::RelayProbe& probe, const transport::RelayProbe& operators,
                const SessionProbe& sessions, metrics::Exposition& page);

}  // namespace uplink::session
