#pragma once

#include <string>
#include <vector>

#include "schema/cyberwave/topic_kinds.h"
#include "server/mqtt/settings.h"

namespace uplink::broker {

/// What a connection subscribes to under these prefixes: what is durable at QoS 1, the rest at
/// QoS 0. Pure.
[[nodiscard]] std::vector<mqtt::Filter> FiltersOf(cyberwave::Connection connection,
                                                  const std::vector<std::string>& prefixes);

}  // namespace uplink::broker
