#pragma once

#include "metrics/exposition.h"
#include "server/broker/broker.h"

namespace uplink::broker {

/// Adds the counts of reading the broker to a page of metrics. Any thread.
void AddSamples(const Broker& broker, metrics::Exposition& page);

}  // namespace uplink::broker
