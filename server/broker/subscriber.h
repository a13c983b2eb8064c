#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "schema/cyberwave/topic_kinds.h"
#include "server/mqtt/client.h"
#include "server/mqtt/probe.h"

namespace uplink::broker {

using cyberwave::Connection;

/// In the order of cyberwave::Connection.
inline constexpr auto kConnectionNames =
    std::to_array<std::string_view>({"durable", "live", "media"});

[[nodiscard]] constexpr std::string_view Name(Connection connection) {
  return kConnectionNames[static_cast<std::size_t>(connection)];
}

/// Events of the connections. Thread: the connections'.
class SubscriberEvents {
 public:
  virtual ~SubscriberEvents() = default;
  virtual void OnConnected(Connection connection, const mqtt::Connected& connected) = 0;
  virtual void OnSubscribed(Connection connection) = 0;
  virtual void OnMessage(Connection connection, const mqtt::Message& message) = 0;
  virtual void OnTrouble(Connection connection, const mqtt::Trouble& trouble) = 0;
  virtual void OnEnded(Connection connection, const mqtt::End& end) = 0;
};

/// One connection to the broker. It passes on its client's events, with the connection's name. Each
/// lease gets a new client.
///
/// Thread:  confined to the client's; the counts of probe() from any.
class Subscriber final : public mqtt::ClientListener {
 public:
  /// `events` outlives it.
  Subscriber(Connection connection, SubscriberEvents& events)
      : connection_(connection), events_(events) {}

  [[nodiscard]] mqtt::ClientProbe& probe() { return probe_; }
  [[nodiscard]] const mqtt::ClientProbe& probe() const { return probe_; }
  /// Null while there is none.
  [[nodiscard]] mqtt::Client* client() { return client_.get(); }
  void SetClient(std::unique_ptr<mqtt::Client> client) { client_ = std::move(client); }
  [[nodiscard]] bool subscribed() const { return subscribed_; }

  void OnConnected(const mqtt::Connected& connected) override {
    events_.OnConnected(connection_, connected);
  }
  void OnSubscribed() override {
    subscribed_ = true;
    events_.OnSubscribed(connection_);
  }
  void OnMessage(const mqtt::Message& message) override { events_.OnMessage(connection_, message); }
  void OnTrouble(const mqtt::Trouble& trouble) override { events_.OnTrouble(connection_, trouble); }
  void OnEnded(const mqtt::End& end, milliseconds /*pause*/) override {
    subscribed_ = false;
    events_.OnEnded(connection_, end);
  }
  /// The client was stopped, and does not report that itself.
  void NoteStopped() { subscribed_ = false; }

 private:
  const Connection connection_;
  SubscriberEvents& events_;
  mqtt::ClientProbe probe_;
  std::unique_ptr<mqtt::Client> client_;
  bool subscribed_ = false;
};

}  // namespace uplink::broker
