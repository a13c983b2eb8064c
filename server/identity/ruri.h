#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::identity {

/// With what every RURI begins.
inline constexpr std::string_view kRuriScheme = "rcan://";

/// Why this is no RURI, as the end of a sentence ("names nothing"); nothing if it is one. The rules
/// of a certificate's name, and of the robot that a gateway names.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfRuri(std::string_view ruri);

/// Whether this RURI, also as a shorthand or with a signature, is one that only a twin has. Whose
/// twins are says their broker: no certificate may name them, and no gateway speaks for them.
///
/// Thread: pure; any thread.
[[nodiscard]] bool IsTwins(std::string_view ruri);

}  // namespace uplink::identity
