#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::identity {

/// The start of every RURI.
inline constexpr std::string_view kRuriScheme = "rcan://";

/// Why this is no RURI, as the end of a sentence ("names nothing"); nothing if it is one. The rules
/// for a certificate's name, and for the robot that a gateway names.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfRuri(std::string_view ruri);

/// Why a new robot may not have this RURI, as the end of a sentence; nothing if it may. It must be
/// in the one form that no other spelling of it has: a host in lower case without a trailing dot,
/// and neither query nor fragment.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfForm(std::string_view ruri);

/// Whether this RURI, also as a shorthand or with a signature, is a twin's. Twins report only
/// through their broker: no certificate may name one, and no gateway may speak for one.
///
/// Thread: pure; any thread.
[[nodiscard]] bool NamesTwin(std::string_view ruri);

}  // namespace uplink::identity
