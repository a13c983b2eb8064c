#pragma once

#include <cstdint>
#include <string>

namespace uplink::synthetic {

/// How surely a message is to come to the broker, as MQTT numbers it.
enum class Qos : std::uint8_t { k0 = 0, k1 = 1 };

/// One message as it leaves for the broker. A value.
struct Publication {
  /// Within its twin, from 1; what is published at QoS 1 is told of by it when it is acked.
  std::uint64_t number = 0;
  std::string topic;
  std::string payload;
  Qos qos = Qos::k0;
  bool retain = false;
};

}  // namespace uplink::synthetic
