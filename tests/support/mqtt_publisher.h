#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/raw_tcp.h"

namespace uplink::testing {

/// A publisher over plain TCP that waits for each answer: by MQTT 3.1.1, or by MQTT 5 with
/// properties that are not judged. What goes wrong ends the test program: it is the test's own bug.
/// Confined to one thread.
class MqttPublisher final {
 public:
  struct Mqtt5 {};
  MqttPublisher(std::uint16_t port, Mqtt5 version);
  /// `id` empty: the broker makes one up. Connects with a clean session.
  explicit MqttPublisher(std::uint16_t port, const std::string& id = {},
                         const std::string& user = {}, const std::string& password = {});

  /// At QoS 1; waits for the broker's PUBACK.
  void Publish(std::string_view topic, std::string_view payload);
  /// The same by MQTT 5, with the bytes of its properties; somebody must be subscribed.
  void PublishWith(std::string_view properties, std::string_view topic, std::string_view payload);
  /// At QoS 0, and a PINGREQ behind it whose answer says that the broker has it.
  void PublishLive(std::string_view topic, std::string_view payload);

  [[nodiscard]] RawTcp& tcp() { return tcp_; }

 private:
  void Send(std::string_view bytes);
  /// Waits for these bytes next.
  void Expect(std::string_view bytes);
  /// Waits for a packet of less than 128 bytes, which begins with `first`, and takes it.
  void ExpectPacket(char first);
  void ReceiveBytes(std::size_t count);

  RawTcp tcp_;
  std::string received_;
  std::uint16_t id_ = 0;
};

}  // namespace uplink::testing
