#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::synthetic {

/// Where a broker listens. A value.
struct BrokerAddress {
  std::string host;
  std::uint16_t port = 0;
  bool tls = false;
};

/// Reads `mqtt://HOST:PORT` or `mqtts://HOST:PORT`, an IPv6 host in brackets.
///
/// Errors: kInvalidArgument, naming what is wrong.
[[nodiscard]] absl::StatusOr<BrokerAddress> ParseBrokerUrl(const std::string& url);

/// The versions of the protocol, by the numbers that CONNECT has for them.
enum class MqttVersion : std::uint8_t { k311 = 4, k5 = 5 };

/// How one connection is made. A value.
struct BrokerSettings {
  BrokerAddress address;
  /// Empty: the broker takes anybody.
  std::string username;
  std::string password;
  /// PEM of who vouches for the broker, with `address.tls`.
  std::string ca_file;
  MqttVersion version = MqttVersion::k5;
  /// Empty: the library makes one up.
  std::string client_id;
};

}  // namespace uplink::synthetic
