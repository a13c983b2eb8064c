#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/broker_url.h"
#include "tools/uplink-fleet/twin/voice.h"

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

/// Publications at QoS 1 that the library has under way at most; the broker may say less.
inline constexpr int kBrokerWindow = 64;
/// Between two signs of life of a quiet connection.
inline constexpr int kBrokerKeepaliveSeconds = 30;

/// What comes by a connection. All of it is called within BrokerLink::Turn.
class BrokerListener {
 public:
  virtual ~BrokerListener() = default;
  /// The broker has let us in; it knows no subscription of ours yet.
  virtual void OnConnected() = 0;
  /// The broker has this publication, if `refused` is empty; else why it does not take it.
  virtual void OnAcked(int id, std::string_view refused) = 0;
  virtual void OnMessage(std::string_view topic, std::string_view payload) = 0;
};

/// libmosquitto's own set-up, which must be there before the first connection and be gone after the
/// last. One per program.
class BrokerLibrary final {
 public:
  BrokerLibrary();
  ~BrokerLibrary();
  BrokerLibrary(const BrokerLibrary&) = delete;
  BrokerLibrary& operator=(const BrokerLibrary&) = delete;
};

/// One connection to a broker, by libmosquitto without threads of its own: all goes on in Turn. A
/// new connection begins a new session at the broker; what was published at QoS 1 and not acked is
/// published again on it.
///
/// Errors: kUnavailable for the network and a broker that refuses the connection, with its reason;
///         kInvalidArgument for settings that the library refuses.
/// Thread: confined to one thread. Connecting and TLS's handshake block.
class BrokerLink final {
 public:
  /// `listener` must outlive this.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<BrokerLink>> Create(
      const BrokerSettings& settings, BrokerListener& listener);
  ~BrokerLink();
  BrokerLink(const BrokerLink&) = delete;
  BrokerLink& operator=(const BrokerLink&) = delete;

  /// Opens the connection; OnConnected says when it may be used. Also after one that ended.
  [[nodiscard]] absl::Status Connect();
  /// Reads and writes what there is, for `wait` at most. An error means that the connection ended.
  [[nodiscard]] absl::Status Turn(milliseconds wait);
  /// True if the network has taken all that was published; more would wait in our memory.
  [[nodiscard]] bool HasRoom() const;
  /// Returns the id that OnAcked names, at QoS 1.
  [[nodiscard]] absl::StatusOr<int> Publish(const Publication& publication);
  /// At QoS 0.
  [[nodiscard]] absl::Status Subscribe(const std::string& filter);
  /// Says goodbye; Turn ends then.
  void Disconnect();

 private:
  struct Impl;
  explicit BrokerLink(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::synthetic
