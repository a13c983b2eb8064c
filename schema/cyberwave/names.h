#pragma once

#include <functional>
#include <set>
#include <string>

namespace uplink::cyberwave {

/// Names that an operator configured, looked up by views.
using Names = std::set<std::string, std::less<>>;

}  // namespace uplink::cyberwave
