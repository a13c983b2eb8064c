#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/mqtt/client.h"
#include "tests/support/eventually.h"

namespace uplink::testing {

/// A message as a test keeps it.
struct ClientMessage {
  std::string topic;
  std::string payload;
  bool read = true;
  std::size_t bytes = 0;
  bool dup = false;
  bool again = false;
  bool retained = false;
  std::string correlation;
  std::optional<mqtt::AckHandle> ack;
};

/// An event loop on the test's own thread, which runs while the test waits. Confined to one thread.
class MqttWorld final {
 public:
  MqttWorld();
  ~MqttWorld();
  MqttWorld(const MqttWorld&) = delete;
  MqttWorld& operator=(const MqttWorld&) = delete;

  /// Runs the loop until the condition holds; false if it does not within `patience`.
  [[nodiscard]] bool Until(const std::function<bool()>& condition,
                           milliseconds patience = kPatience);
  [[nodiscard]] std::shared_ptr<mqtt::Link> MakeLink(mqtt::LinkEvents& events);
  [[nodiscard]] mqtt::ConnectionNumbers& numbers() { return numbers_; }

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
  mqtt::ConnectionNumbers numbers_;
};

/// Settings of a client of a broker on loopback, without TLS, with short pauses.
[[nodiscard]] mqtt::ClientSettings LoopbackSettings(std::uint16_t port, mqtt::Version version);

/// A client, and what it told. Its world outlives it.
class WorldClient final : public mqtt::ClientListener {
 public:
  WorldClient(MqttWorld& world, const mqtt::ClientSettings& settings);
  ~WorldClient() override;
  WorldClient(const WorldClient&) = delete;
  WorldClient& operator=(const WorldClient&) = delete;

  void OnConnected(const mqtt::Connected& connected) override { connections.push_back(connected); }
  void OnSubscribed() override { ++subscribed; }
  void OnMessage(const mqtt::Message& message) override;
  void OnTrouble(const mqtt::Trouble& trouble) override { troubles.push_back(trouble); }
  void OnEnded(const mqtt::End& end, milliseconds pause) override;

  mqtt::Client* operator->() { return client_.get(); }

  /// Starts, and waits until all filters are answered.
  [[nodiscard]] bool Subscribe(const std::vector<mqtt::Filter>& filters);
  [[nodiscard]] bool UntilMessages(std::size_t count);
  [[nodiscard]] bool UntilEnds(std::size_t count);
  [[nodiscard]] bool UntilSubscribed(int times);
  /// Takes its connection away as a kill would: the broker hears nothing of it but the end.
  void Kill();
  [[nodiscard]] std::vector<std::string> Payloads() const;

  mqtt::ClientProbe probe;
  std::vector<mqtt::Connected> connections;
  int subscribed = 0;
  std::deque<ClientMessage> messages;
  std::vector<mqtt::Trouble> troubles;
  std::vector<mqtt::End> ends;
  std::vector<milliseconds> pauses;
  /// Called after a message was kept.
  std::function<void(const ClientMessage&)> on_message;

 private:
  MqttWorld& world_;
  SystemClock clock_;
  std::shared_ptr<mqtt::Link> link_;
  std::unique_ptr<mqtt::Client> client_;
};

}  // namespace uplink::testing
