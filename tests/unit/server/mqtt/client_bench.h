#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/mqtt/client.h"
#include "tests/support/manual_clock.h"
#include "tests/support/mqtt_bytes.h"
#include "tests/unit/server/mqtt/fake_link.h"

namespace uplink::testing {

/// A message as a test keeps it.
struct KeptMessage {
  std::string topic;
  std::string payload;
  bool dup = false;
  bool again = false;
  bool read = true;
  bool bad_topic = false;
  std::size_t bytes = 0;
  std::optional<mqtt::AckHandle> ack;
};

/// A client on a link and a clock that the test moves.
class ClientBench : public mqtt::ClientListener {
 public:
  explicit ClientBench(const std::function<void(mqtt::ClientSettings&)>& change = {}) {
    mqtt::ClientSettings settings;
    settings.url = {false, "broker", 1883};
    settings.client_id = "core";
    settings.kept_session = true;
    settings.unacked_max = 2;
    if (change) change(settings);
    version_ = settings.version;
    settings_ = settings;
    Renew();
  }
  /// Another client in place of the one that there is.
  void Renew() {
    client.reset();
    auto made = mqtt::Client::Create(settings_, {*this, probe, clock, [] { return 0U; },
                                                 [this](mqtt::LinkEvents& events) {
                                                   link = std::make_shared<FakeLink>(events);
                                                   return link;
                                                 },
                                                 numbers_});
    client = *std::move(made);
  }

  void OnConnected(const mqtt::Connected& connected) override { connections.push_back(connected); }
  void OnSubscribed() override { ++subscribed; }
  void OnMessage(const mqtt::Message& message) override {
    const mqtt::Publish& publish = message.publish;
    messages.push_back({.topic = std::string(publish.topic),
                        .payload = std::string(publish.payload.value_or("")),
                        .dup = publish.dup,
                        .again = message.again,
                        .read = publish.payload.has_value(),
                        .bad_topic = publish.bad_topic,
                        .bytes = publish.payload_bytes,
                        .ack = message.ack});
    if (on_message) on_message();
  }
  void OnTrouble(const mqtt::Trouble& trouble) override { troubles.push_back(trouble); }
  void OnEnded(const mqtt::End& end, milliseconds pause) override {
    ends.push_back(end);
    pauses.push_back(pause);
    if (on_ended) on_ended();
  }

  [[nodiscard]] std::string AcceptBytes(bool session_present) const {
    const std::string begin = session_present ? Raw("\1\0") : Raw("\0\0");
    return MqttPacket(0x20, version_ == mqtt::Version::k5 ? begin + Raw("\0") : begin);
  }
  [[nodiscard]] std::string MessageBytes(std::string payload, std::size_t id = 0,
                                         bool dup = false) const {
    return PublishBytes{
        .payload = std::move(payload), .id = id, .dup = dup, .mqtt5 = version_ == mqtt::Version::k5}
        .Text();
  }

  /// The connection comes up, and what is being written leaves.
  void Up() {
    link->events()->OnPhase(mqtt::LinkPhase::kConnecting);
    link->events()->OnUp();
    Flush();
  }
  /// A connection that the broker accepted, without filters.
  void Connect(bool session_present = false) {
    Up();
    link->Bring(AcceptBytes(session_present));
    Flush();
    link->written.clear();
  }
  /// Starts, and is connected.
  void Begin() {
    client->Start();
    Connect();
  }
  void Flush() {
    while (!link->closed && link->writing) link->FinishWrite();
  }
  /// What was written since the last call.
  [[nodiscard]] std::string Written() {
    Flush();
    return std::exchange(link->written, {});
  }
  /// Moves the clock to each time at which the link is to wake the client, up to `by` from now.
  void Advance(milliseconds by) {
    const SteadyTime end = clock.Steady() + by;
    while (link->wake_at <= end) {
      const auto step = std::chrono::ceil<milliseconds>(link->wake_at - clock.Steady());
      if (step.count() > 0) clock.Advance(step);
      link->wake_at = SteadyTime::max();
      link->events()->OnDue();
      Flush();
    }
    clock.Advance(std::chrono::duration_cast<milliseconds>(end - clock.Steady()));
  }
  [[nodiscard]] std::vector<std::string> Payloads() const {
    std::vector<std::string> payloads;
    for (const KeptMessage& each : messages) payloads.push_back(each.payload);
    return payloads;
  }

  ManualClock clock;
  mqtt::ClientProbe probe;
  std::shared_ptr<FakeLink> link;
  std::vector<mqtt::Connected> connections;
  int subscribed = 0;
  std::vector<KeptMessage> messages;
  std::vector<mqtt::Trouble> troubles;
  std::vector<mqtt::End> ends;
  std::vector<milliseconds> pauses;
  std::function<void()> on_message;
  std::function<void()> on_ended;
  std::unique_ptr<mqtt::Client> client;

 private:
  mqtt::ConnectionNumbers numbers_;
  mqtt::ClientSettings settings_;
  mqtt::Version version_ = mqtt::Version::k5;
};

}  // namespace uplink::testing
