#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>

namespace uplink::config {

/// Where a broker is. A value.
struct BrokerUrl {
  bool tls = true;
  /// A name or an address; one of IPv6 without its brackets.
  std::string host;
  std::uint16_t port = 0;

  /// As it is written, for messages.
  [[nodiscard]] std::string Text() const;

  friend bool operator==(const BrokerUrl&, const BrokerUrl&) = default;
};

inline constexpr std::uint16_t kMqttsPort = 8883;
inline constexpr std::uint16_t kMqttPort = 1883;
/// Bytes of a host: those of a name in the DNS.
inline constexpr std::size_t kBrokerHostBytesMax = 253;

/// Takes apart `mqtts://host[:port]` or `mqtt://host[:port]`; a single slash may follow. The port
/// is by default that of the scheme.
///
/// Errors: kInvalidArgument, beginning with `mqtt.url`: another scheme, no host, a host over
///         kBrokerHostBytesMax or with characters that none has, a port that is none, a user (that
///         belongs in mqtt.username), a path. The text never repeats what may be a password.
[[nodiscard]] absl::StatusOr<BrokerUrl> ParseBrokerUrl(std::string_view text);

}  // namespace uplink::config
