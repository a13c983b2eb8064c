#pragma once

#include "metrics/exposition.h"
#include "server/forward/forwards.h"
#include "server/forward/probe.h"

namespace uplink::forward {

/// What is shared and what became of its changes, for a page of metrics: due is the sum of settled
/// and waiting in each text. Any thread.
void AddSamples(const Forwards& forwards, const ForwardProbe& probe, metrics::Exposition& page);

}  // namespace uplink::forward
