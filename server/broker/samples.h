#pragma once

#include "metrics/exposition.h"
#include "server/broker/broker.h"

namespace uplink::broker {

/// What the reading of the broker counts, for a page of metrics. Any thread.
void AddSamples(const Broker& broker, metrics::Exposition& page);

}  // namespace uplink::broker
