#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>

#include <netinet/in.h>
#include <sys/socket.h>

namespace uplink::front {

/// A source that shares places as one: an IPv4 address, or the /64 of an IPv6 address, since one
/// owner usually has all of a /64. A value; the default one is "unknown".
class SourceAddress final {
 public:
  SourceAddress() = default;

  /// The source of a peer. IPv4 in IPv6 (::ffff:192.0.2.1) is the same source as the IPv4 address;
  /// other families are unknown.
  [[nodiscard]] static SourceAddress Of(const sockaddr_storage& peer);
  [[nodiscard]] static SourceAddress Of(const in_addr& address);
  [[nodiscard]] static SourceAddress Of(const in6_addr& address);

  /// "192.0.2.1", "2001:db8:1:2::/64" or "unknown".
  [[nodiscard]] std::string ToText() const;

  [[nodiscard]] const std::array<std::uint8_t, 16>& bytes() const { return bytes_; }

  friend auto operator<=>(const SourceAddress&, const SourceAddress&) = default;

 private:
  /// IPv4 as IPv4 in IPv6; otherwise the first 64 bits, zeros and the prefix length, so that ::/64
  /// differs from unknown.
  std::array<std::uint8_t, 16> bytes_{};
};

static_assert(sizeof(SourceAddress) == 16);

}  // namespace uplink::front
