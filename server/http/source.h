#pragma once

#include <array>
#include <cstdint>

namespace uplink::http {

/// Who connects, and shares places as one: an IPv4 address as IPv4 in IPv6, or the /64 of an IPv6
/// address, since one owner usually has all of a /64. A value; the default one is "unknown".
using Source = std::array<std::uint8_t, 16>;

/// The source of an IPv6 address, or of an IPv4 address in IPv6 (::ffff:192.0.2.1). A pure
/// function.
[[nodiscard]] Source SourceOf(const std::array<std::uint8_t, 16>& address);

}  // namespace uplink::http
