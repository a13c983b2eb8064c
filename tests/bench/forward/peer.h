#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "schema/base/clock.h"
#include "tests/bench/forward/deliveries.h"
#include "tests/bench/load/client.h"

namespace uplink::bench {

enum class FanOutProtocol : std::uint8_t { kRelay, kMqttQos0, kMqttQos1, kNats };

/// Whom the clients of a fan-out belong to. The references outlive the clients.
struct FanOut {
  FanOutProtocol protocol = FanOutProtocol::kRelay;
  const Clock& clock;
  /// Who publishes is named so in what brokers carry.
  std::string origin_ruri;
  Deliveries& deliveries;
};
enum class FanOutRole : std::uint8_t { kPublisher, kReceiver };

/// A client that connects at once and publishes an update per message, or one that receives them
/// all. It is ready once what it asked for is granted. `number` tells clients apart.
[[nodiscard]] std::unique_ptr<Client> ConnectPeer(const FanOut& fan_out, FanOutRole role,
                                                  link::Loop& loop, link::LinkOptions options,
                                                  std::size_t number);

}  // namespace uplink::bench
