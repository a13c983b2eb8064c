#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tests/unit/server/mqtt/fake_link.h"

namespace uplink::simulation {

/// A broker of MQTT 3.1.1 with one kept session: it delivers at QoS 1 until it has a PUBACK, in the
/// order of publication, and again with DUP after each break.
///
/// Thread: confined to its caller.
class SimBroker final {
 public:
  /// A message and its number, which grows.
  struct Message {
    std::uint64_t number = 0;
    std::string topic;
    std::string payload;
  };
  /// The server acked the message.
  using Acked = std::function<void(std::uint64_t number)>;
  SimBroker(const Clock& clock, Acked acked) : clock_(clock), acked_(std::move(acked)) {}

  void Publish(Message message) { queue_.push_back(std::move(message)); }
  /// The server made a link.
  std::shared_ptr<mqtt::Link> Connect(mqtt::LinkEvents& events);
  /// All that the server's side of the links has to do now; what it wrote arrives.
  void Progress();
  /// The next message reaches the server, or the next that comes again. False if none may.
  bool Deliver();
  /// Every connection breaks. PUBACKs that were written may be lost with it: `lost` of the last
  /// ones.
  void Break(std::size_t lost);
  /// The same, and the server's process is gone.
  void Forget(std::size_t lost);

  /// The message that Deliver delivered last.
  [[nodiscard]] std::uint64_t delivered() const { return delivered_; }
  /// Messages that the broker holds.
  [[nodiscard]] std::size_t waiting() const { return queue_.size() + unacked_.size(); }
  [[nodiscard]] std::uint64_t redelivered() const { return redelivered_; }

 private:
  struct Line {
    std::shared_ptr<testing::FakeLink> link;
    bool up = false;
    bool is_durable = false;
    bool subscribed = false;
    std::string from_server;
    std::string to_server;
  };
  struct Unacked {
    Message message;
    std::uint16_t id = 0;
    /// The present connection must still deliver it.
    bool due = true;
    bool dup = false;
  };
  void ProgressOf(Line& line);
  void Take(Line& line);
  void OnPacket(Line& line, unsigned type, std::string_view body);
  void OnPuback(std::uint16_t id);
  /// The client connects anew: what it did not ack is delivered again, in order.
  void SendAgain();
  [[nodiscard]] Line* Durable();
  [[nodiscard]] std::uint16_t NextId();

  const Clock& clock_;
  const Acked acked_;
  std::deque<Message> queue_;
  std::deque<Unacked> unacked_;
  /// PUBACKs that the server wrote last: a break may lose them.
  std::deque<Unacked> acked_last_;
  std::vector<Line> lines_;
  bool has_session_ = false;
  std::uint16_t last_id_ = 0;
  std::uint64_t redelivered_ = 0;
  std::uint64_t delivered_ = 0;
};

}  // namespace uplink::simulation
