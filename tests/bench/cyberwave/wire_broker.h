#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::bench {

/// A broker of one subscriber that speaks MQTT 5: it takes its connections, grants what they ask
/// for, and publishes on the one that asked for durable messages. So the time between a PUBLISH and
/// its PUBACK is that of the wire and the subscriber alone.
///
/// Errors: what it does not expect aborts the benchmark.
/// Thread: confined to one thread.
class WireBroker final {
 public:
  explicit WireBroker(const Clock& clock);
  ~WireBroker();
  WireBroker(const WireBroker&) = delete;
  WireBroker& operator=(const WireBroker&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Waits until a connection asked for `filter`, and uses that one from now on.
  void WaitFor(std::string_view filter);
  /// Publishes at QoS 1; how long until its PUBACK was here, in ms.
  [[nodiscard]] double Publish(std::string_view topic, std::string_view payload);
  /// Answers pings for so long.
  void Rest(milliseconds duration);

 private:
  struct Connection {
    int socket = -1;
    std::string in;
    /// What it asked for, as it came.
    std::string asked;
    /// Of its last PUBACK.
    std::uint16_t acked = 0;
  };

  void Work(milliseconds wait_max);
  void Accept();
  void Read(Connection& connection);
  static void Answer(Connection& connection, char head, std::string_view body);

  const Clock& clock_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::vector<Connection> connections_;
  std::size_t durable_ = 0;
  std::uint16_t last_id_ = 0;
};

}  // namespace uplink::bench
