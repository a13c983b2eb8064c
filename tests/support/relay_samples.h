#pragma once

#include <cstdint>
#include <string>

#include "schema/model/ids.h"

namespace uplink::testing {

/// A fault report, as an agent encodes it: durable.
[[nodiscard]] std::string FaultPayload(const std::string& fault_id);
/// A motion report: live.
[[nodiscard]] std::string MotionPayload(double lat_deg = 52.0);
/// A session id that `number` tells apart.
[[nodiscard]] model::SessionId SessionOf(std::uint8_t number);
/// A robot's address that `number` tells apart.
[[nodiscard]] std::string RuriOf(int number);

}  // namespace uplink::testing
