#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/config/config.h"
#include "server/config/relations.h"

namespace uplink::config {

/// The rules of CheckRelations that concern the broker and what is read from it, whether or not
/// `mqtt.url` names one. Pure.
[[nodiscard]] std::vector<Breach> CheckBroker(const Config& config);

/// A warning if `mqtt.url` leads over a network without TLS; nothing otherwise.
[[nodiscard]] std::optional<std::string> UnverifiedBrokerText(const MqttConfig& mqtt);

}  // namespace uplink::config
