#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schema/cyberwave/topic_kinds.h"

namespace uplink::cyberwave {

/// The subscription filters of a connection under one prefix (prefix.h): one for each topic that it
/// reads, and no other. Pure.
[[nodiscard]] std::vector<std::string> Filters(std::string_view prefix, Connection connection);

}  // namespace uplink::cyberwave
