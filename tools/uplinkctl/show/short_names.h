#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/uplinkctl/show/columns.h"

// Names of robots as people say them. Pure; any thread.
namespace uplink::ctl {

/// The last `count` segments of a RURI; all of it if it has no more.
[[nodiscard]] std::string_view LastSegments(std::string_view ruri, int count);

/// Names for these RURIs: the last segment if no other ends with it, else the last two, else all.
[[nodiscard]] ShortNames ShortNamesOf(const std::vector<std::string>& ruris);

}  // namespace uplink::ctl
