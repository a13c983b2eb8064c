#pragma once

#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/cyberwave/topic.h"

namespace uplink::cyberwave {

/// Where a ping of that topic is answered: under the same prefix, and the name as it came.
[[nodiscard]] std::string PongTopic(const Topic& ping);

/// What it is answered with: our clock, in seconds with three places.
[[nodiscard]] std::string PongPayload(SystemTime now);

}  // namespace uplink::cyberwave
