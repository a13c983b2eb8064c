#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::view {

/// The token of the page of robots that follows `last_ruri`.
[[nodiscard]] std::string RobotsToken(std::string_view last_ruri);
/// The RURI in a token that RobotsToken made, or nothing.
[[nodiscard]] std::optional<std::string> RuriFromToken(std::string_view token);

/// The same of the list of fleets, by their names.
[[nodiscard]] std::string FleetsToken(std::string_view last_fleet);
[[nodiscard]] std::optional<std::string> FleetFromToken(std::string_view token);

}  // namespace uplink::view
