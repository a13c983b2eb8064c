#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/raw_tcp.h"

namespace uplink::testing {

/// A publisher of MQTT 3.1.1 over plain TCP that waits for each answer. What goes wrong ends the
/// test program: it is the test's own bug. Confined to one thread.
class MqttPublisher final {
 public:
  /// `id` empty: the broker makes one up. Connects with a clean session.
  explicit MqttPublisher(std::uint16_t port, const std::string& id = {},
                         const std::string& user = {}, const std::string& password = {});

  /// At QoS 1; waits for the broker's PUBACK.
  void Publish(std::string_view topic, std::string_view payload);
  /// At QoS 0, and a PINGREQ behind it whose answer says that the broker has it.
  void PublishLive(std::string_view topic, std::string_view payload);

  [[nodiscard]] RawTcp& tcp() { return tcp_; }

 private:
  void Send(std::string_view bytes);
  /// Waits for these bytes next.
  void Expect(std::string_view bytes);

  RawTcp tcp_;
  std::string received_;
  std::uint16_t id_ = 0;
};

}  // namespace uplink::testing
