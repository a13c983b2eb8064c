#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>
#include <sys/socket.h>

namespace uplink::config {

/// Addresses that begin alike: `10.0.0.0/8`, `2001:db8::/32`, or one address alone. A value.
///
/// IPv4 in IPv6 (::ffff:192.0.2.1) counts as IPv4, which no network of IPv6 holds: not `::/0`.
class Network final {
 public:
  /// Errors: kInvalidArgument repeats the text and says what is wrong with it in one sentence: no
  ///         literal address, a prefix that is longer than it, or bits that are set beyond the
  ///         prefix.
  [[nodiscard]] static absl::StatusOr<Network> Parse(std::string_view text);

  /// Another family than the two is in no network.
  [[nodiscard]] bool Contains(const sockaddr_storage& address) const;
  /// The text that Parse reads back.
  [[nodiscard]] std::string ToText() const;

  friend bool operator==(const Network&, const Network&) = default;

 private:
  using Bytes = std::array<std::uint8_t, 16>;

  Network(const Bytes& bytes, unsigned prefix_bits) : bytes_(bytes), prefix_bits_(prefix_bits) {}
  [[nodiscard]] bool is_ipv4() const;

  /// IPv4 as IPv4 in IPv6.
  Bytes bytes_;
  /// Of these bytes.
  unsigned prefix_bits_;
};

/// Reads each; the first that is no network is the error.
[[nodiscard]] absl::StatusOr<std::vector<Network>> ParseNetworks(
    const std::vector<std::string>& texts);

/// This machine: 127.0.0.0/8 and ::1.
[[nodiscard]] std::vector<Network> LoopbackNetworks();

/// Whether any of them holds the address.
[[nodiscard]] bool Contains(const std::vector<Network>& networks, const sockaddr_storage& address);

}  // namespace uplink::config
