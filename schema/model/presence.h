#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::model {

/// Whether a robot is there (protocol: Presence). The numbers are what stores keep.
enum class Presence : std::uint8_t { kUnknown = 0, kOnline = 1, kOffline = 2 };

/// `unknown`, `online` or `offline`.
[[nodiscard]] std::string_view ToText(Presence presence);
/// The presence that ToText spells so, or nothing.
[[nodiscard]] std::optional<Presence> PresenceFromText(std::string_view text);

}  // namespace uplink::model
