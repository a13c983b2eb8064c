#pragma once

#include <vector>

#include "server/config/config.h"
#include "server/config/relations.h"

namespace uplink::config {

/// What CheckRelations finds in the keys of listen.http: who may reach it, and how. Pure.
[[nodiscard]] std::vector<Breach> CheckHttp(const Config& config);

}  // namespace uplink::config
