#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::identity {

/// Bytes of the longest name of a fleet.
inline constexpr std::size_t kFleetBytesMax = 256;
/// In a certificate of an operator: all fleets. No fleet has this name.
inline constexpr std::string_view kAllFleets = "*";

/// Why this is no name of a fleet, as the end of a sentence ("is empty"); nothing if it is one, or
/// kAllFleets. The rules of a certificate's O, and of the fleet that the configuration names.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfFleet(std::string_view fleet);

/// As FlawOfFleet, for a name that is chosen now: a character that is not seen (UnseenCharacter) is
/// a flaw too. The relay takes such a name only for a fleet that the store has robots of. `fleet`
/// must be well-formed UTF-8.
[[nodiscard]] std::optional<std::string> FlawOfNewFleet(std::string_view fleet);

}  // namespace uplink::identity
