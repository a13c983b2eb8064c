#pragma once

#include <vector>

#include "server/config/config.h"
#include "server/config/relations.h"

namespace uplink::config {

/// The rules of CheckRelations that concern the broker and what is read from it, whether or not
/// `mqtt.url` names one. Pure.
[[nodiscard]] std::vector<Breach> CheckBroker(const Config& config);

}  // namespace uplink::config
