#pragma once

#include <cstdint>
#include <string>

#include "server/config/broker_url.h"

namespace uplink::synthetic {

/// The versions of the protocol, by the numbers that CONNECT has for them.
enum class MqttVersion : std::uint8_t { k311 = 4, k5 = 5 };

/// How one connection is made. A value.
struct BrokerSettings {
  config::BrokerUrl url;
  /// Empty: the broker takes anybody.
  std::string username;
  std::string password;
  /// PEM of who vouches for the broker, with `url.tls`.
  std::string ca_file;
  MqttVersion version = MqttVersion::k5;
  /// Empty: the library makes one up.
  std::string client_id;
};

}  // namespace uplink::synthetic
