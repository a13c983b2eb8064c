#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "tools/link/loop.h"
#include "tools/link/tls_link.h"

namespace uplink::bench {

/// One connection of a benchmark's load: it sends messages and counts how many the server took. The
/// protocol is the derived class's.
///
/// Thread: confined to the loop's thread.
class Client {
 public:
  virtual ~Client() = default;

  /// Sends one frame with so many messages; only when ready().
  virtual void Send(std::size_t messages) = 0;
  /// Bytes that the server, or the kernel, does not take yet.
  [[nodiscard]] virtual std::size_t unsent() const = 0;

  /// The server greeted it, and it was not refused or cut since.
  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t acked() const { return acked_; }
  /// Called whenever acked() or unsent() moved.
  void SetOnMoved(std::function<void()> moved) { moved_ = std::move(moved); }

 protected:
  void Moved() const {
    if (moved_) moved_();
  }
  void Fail(std::string error) {
    ready_ = false;
    failed_ = true;
    error_ = std::move(error);
  }

  bool ready_ = false;
  bool failed_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t acked_ = 0;

 private:
  std::string error_;
  std::function<void()> moved_;
};

/// The protocols that are compared. MQTT is at QoS 1 but for the last.
enum class Protocol : std::uint8_t { kRelay, kLengthPrefix, kMqtt, kNats, kMqttQos0 };

/// What a client says and hears. A value.
struct ClientStyle {
  /// Tells clients of a broker apart.
  std::string name = {};
  /// Where brokers publish what it sends.
  std::string topic = {};
  /// Sets the payload of the message with this number.
  std::function<void(std::uint64_t seq, std::string& payload)> write = {};
  /// Gets each message of the others that a broker passes on, and each of a relay before it is
  /// parsed, which goes no further if it is taken.
  std::function<bool(std::string_view message)> takes = {};
  /// It asks for what the others send, and is ready once it will get it.
  bool receives = false;
  /// Its messages are durable: a relay acks them once they are committed.
  bool durable = false;
};
/// Sends Payload() of the sum of both numbers, and wants nothing.
[[nodiscard]] ClientStyle LiveStyle(std::size_t number);

/// Makes a client that connects at once.
[[nodiscard]] std::unique_ptr<Client> Connect(Protocol protocol, link::Loop& loop,
                                              link::LinkOptions options, ClientStyle style);

/// A motion report of about 150 bytes, as an agent encodes it; `variation` changes its numbers.
[[nodiscard]] const std::string& Payload(std::size_t variation);

}  // namespace uplink::bench
