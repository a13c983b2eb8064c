#pragma once

#include <functional>
#include <string_view>

#include "schema/cyberwave/topic.h"
#include "server/broker/probe.h"
#include "server/cyberwave/held.h"
#include "server/cyberwave/pong_limit.h"
#include "server/mqtt/packets.h"

namespace uplink::broker {

/// Answers pings at once, up to a limit. Confined to its owner's thread.
class Pongs final {
 public:
  /// Publishes at QoS 0; false if it could not.
  using Publish = std::function<bool(const mqtt::Outgoing&)>;
  /// `probe` outlives it.
  Pongs(Publish publish, BrokerProbe& probe) : publish_(std::move(publish)), probe_(probe) {}

  /// Answers a ping that arrived on that topic with this correlation data.
  void Answer(const cyberwave::Topic& ping, std::string_view correlation,
              const cyberwave::Arrival& arrived);

 private:
  const Publish publish_;
  BrokerProbe& probe_;
  cyberwave::PongLimit limit_;
};

}  // namespace uplink::broker
