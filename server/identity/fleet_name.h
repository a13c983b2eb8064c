#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::identity {

/// Bytes of the longest name of a fleet.
inline constexpr std::size_t kFleetBytesMax = 256;
/// Means all fleets in an operator's certificate. No fleet has this name.
inline constexpr std::string_view kAllFleets = "*";

/// Why this is no name of a fleet, as the end of a sentence ("is empty"); nothing if it is one, or
/// kAllFleets. The rules for a certificate's O, and for the fleet that the configuration names.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfFleet(std::string_view fleet);

/// As FlawOfFleet, for a name that is chosen now: an invisible character (InvisibleCharacter) is a
/// flaw too. The relay takes such a name only for a fleet that already has robots in the store.
/// `fleet` must be well-formed UTF-8.
[[nodiscard]] std::optional<std::string> FlawOfNewFleet(std::string_view fleet);

}  // namespace uplink::identity
