#pragma once

#include <string>
#include <vector>

#include "schema/cyberwave/topic_kinds.h"
#include "server/mqtt/settings.h"

namespace uplink::broker {

/// The subscriptions of a connection under these prefixes: durable topics at QoS 1, the rest at QoS
/// 0. Pure.
[[nodiscard]] std::vector<mqtt::Filter> FiltersOf(cyberwave::Connection connection,
                                                  const std::vector<std::string>& prefixes);

}  // namespace uplink::broker
