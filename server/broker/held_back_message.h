#pragma once

#include <optional>
#include <string>

#include "server/cyberwave/held.h"
#include "server/mqtt/listener.h"

namespace uplink::broker {

/// A copy of a message that waits for room, with the time of its arrival.
class HeldBackMessage final {
 public:
  HeldBackMessage(const mqtt::Message& message, const cyberwave::Arrival& arrived)
      : arrived_(arrived),
        message_(message),
        topic_(message.publish.topic),
        correlation_(message.publish.correlation),
        payload_(message.publish.payload) {
    message_.publish.topic = topic_;
    message_.publish.correlation = correlation_;
    if (payload_) message_.publish.payload = *payload_;
  }
  HeldBackMessage(const HeldBackMessage&) = delete;
  HeldBackMessage& operator=(const HeldBackMessage&) = delete;

  [[nodiscard]] const mqtt::Message& message() const { return message_; }
  [[nodiscard]] const cyberwave::Arrival& arrived() const { return arrived_; }

 private:
  const cyberwave::Arrival arrived_;
  mqtt::Message message_;
  const std::string topic_;
  const std::string correlation_;
  const std::optional<std::string> payload_;
};

}  // namespace uplink::broker
