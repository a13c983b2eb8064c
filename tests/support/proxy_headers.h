#pragma once

#include <cstdint>
#include <string>
#include <string_view>

// The bytes of PROXY protocol headers of version 2, right and wrong ones (Source: HAProxy's
// proxy-protocol.txt).
namespace uplink::testing {

inline constexpr std::string_view kProxySignature("\r\n\r\n\0\r\nQUIT\n", 12);

inline constexpr std::uint8_t kProxyLocal = 0x20;
inline constexpr std::uint8_t kProxyRelayed = 0x21;

inline constexpr std::uint8_t kProxyUnspec = 0x00;
inline constexpr std::uint8_t kProxyTcp4 = 0x11;
inline constexpr std::uint8_t kProxyTcp6 = 0x21;

/// A header of these parts, whose length is that of `rest`.
[[nodiscard]] std::string ProxyHeaderBytes(std::uint8_t command, std::uint8_t family,
                                           std::string_view rest);
/// The addresses in a header: of this source, an address of IPv4 or IPv6, to one of ours.
[[nodiscard]] std::string ProxyAddresses(const std::string& source, std::uint16_t port);
/// A header for a robot there; `more` follows the addresses.
[[nodiscard]] std::string ProxyHeaderFor(const std::string& source, std::uint16_t port = 4711,
                                         std::string_view more = {});
/// A header that says that the load balancer came on its own account.
[[nodiscard]] std::string LocalProxyHeader();
/// What may follow the addresses: type, length, value.
[[nodiscard]] std::string ProxyTlv(std::uint8_t type, std::string_view value);

}  // namespace uplink::testing
