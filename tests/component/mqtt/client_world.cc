#include "tests/component/mqtt/client_world.h"

#include <utility>

#include <boost/asio/io_context.hpp>

#include "schema/base/check.h"
#include "server/mqtt/asio_link.h"

namespace uplink::testing {

struct MqttWorld::Loop {
  boost::asio::io_context io{1};
};

MqttWorld::MqttWorld() : loop_(std::make_unique<Loop>()) {}
MqttWorld::~MqttWorld() = default;

bool MqttWorld::Until(const std::function<bool()>& condition, milliseconds patience) {
  const SteadyTime end = SystemClock{}.Steady() + patience;
  while (!condition()) {
    if (SystemClock{}.Steady() >= end) return false;
    loop_->io.restart();
    loop_->io.run_one_for(milliseconds(1));
  }
  return true;
}

std::shared_ptr<mqtt::Link> MqttWorld::MakeLink(mqtt::LinkEvents& events) {
  return mqtt::MakeAsioLink(loop_->io, events);
}

mqtt::ClientSettings LoopbackSettings(std::uint16_t port, mqtt::Version version) {
  mqtt::ClientSettings settings;
  settings.url = {false, "127.0.0.1", port};
  settings.version = version;
  settings.client_id = "core";
  settings.kept_session = true;
  settings.reconnect.backoff = {.first = milliseconds(20), .longest = milliseconds(200)};
  return settings;
}

WorldClient::WorldClient(MqttWorld& world, const mqtt::ClientSettings& settings) : world_(world) {
  auto made = mqtt::Client::Create(settings, {*this, probe, clock_, [] { return 0U; },
                                              [this](mqtt::LinkEvents& events) {
                                                link_ = world_.MakeLink(events);
                                                return link_;
                                              },
                                              world_.numbers()});
  UPLINK_CHECK(made.ok(), std::string(made.status().message()));
  client_ = *std::move(made);
}

WorldClient::~WorldClient() = default;

void WorldClient::OnMessage(const mqtt::Message& message) {
  const mqtt::Publish& publish = message.publish;
  messages.push_back({.topic = std::string(publish.topic),
                      .payload = std::string(publish.payload.value_or("")),
                      .read = publish.payload.has_value(),
                      .bytes = publish.payload_bytes,
                      .dup = publish.dup,
                      .again = message.again,
                      .retained = publish.retained,
                      .correlation = std::string(publish.correlation),
                      .ack = message.ack});
  if (on_message) on_message(messages.back());
}

void WorldClient::OnEnded(const mqtt::End& end, milliseconds pause) {
  ends.push_back(end);
  pauses.push_back(pause);
}

bool WorldClient::Subscribe(const std::vector<mqtt::Filter>& filters) {
  UPLINK_CHECK(client_->SetFilters(filters).ok(), "a test's filters");
  client_->Start();
  return UntilSubscribed(subscribed + 1);
}

bool WorldClient::UntilMessages(std::size_t count) {
  return world_.Until([&] { return messages.size() >= count; });
}

bool WorldClient::UntilEnds(std::size_t count) {
  return world_.Until([&] { return ends.size() >= count; });
}

bool WorldClient::UntilSubscribed(int times) {
  return world_.Until([&] { return subscribed >= times; });
}

void WorldClient::Kill() { link_->Close({}); }

std::vector<std::string> WorldClient::Payloads() const {
  std::vector<std::string> payloads;
  for (const ClientMessage& each : messages) payloads.push_back(each.payload);
  return payloads;
}

}  // namespace uplink::testing
