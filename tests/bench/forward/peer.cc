#include "tests/bench/forward/peer.h"

#include <utility>

#include <fmt/core.h>

#include "tests/bench/forward/update.h"
#include "tests/bench/load/byte_client.h"
#include "tests/bench/load/mqtt.h"
#include "tests/bench/load/nats.h"
#include "tests/bench/load/session_id.h"
#include "tools/link/grpc_connection.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {
namespace {

constexpr std::string_view kTopic = "fleet";

/// What all of them are made of.
struct PeerSetup {
  const FanOut& fan_out;
  FanOutRole role = FanOutRole::kReceiver;
  std::size_t number = 0;

  [[nodiscard]] bool publishes() const { return role == FanOutRole::kPublisher; }
  [[nodiscard]] std::string name() const {
    return fmt::format("{}-{}", publishes() ? "publisher" : "receiver", number);
  }
};

/// A robot.
class RelayPeer final : public Client, private link::StreamEvents {
 public:
  RelayPeer(link::Loop& loop, link::LinkOptions options, const PeerSetup& setup)
      : setup_(setup),
        connection_(loop, std::move(options), static_cast<link::StreamEvents&>(*this)) {
    connection_.Connect();
  }

  void Send(std::size_t messages) override {
    v1::RelayRequest frame;
    for (std::size_t i = 0; i < messages; ++i) {
      v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
      uplink.set_seq(++sent_);
      uplink.set_rover_nexus(ReportOf({.number = sent_, .at = setup_.fan_out.clock.Steady()}));
    }
    connection_.Send(frame.SerializeAsString());
  }
  [[nodiscard]] std::size_t unsent() const override { return connection_.unsent(); }

 private:
  void OnConnected() override {
    connection_.OpenStream("/uplink.v1.UplinkRelay/Relay");
    v1::RelayRequest frame;
    frame.mutable_hello()->set_session_id(NewSessionId());
    frame.mutable_hello()->set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
    frame.mutable_hello()->set_agent_version("benchmark");
    connection_.Send(frame.SerializeAsString());
  }
  void OnMessage(std::string_view message) override {
    // Nearly all are updates, and the load has one core.
    if (setup_.fan_out.deliveries.Note(message)) return;
    v1::RelayResponse frame;
    if (!frame.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
      return Fail("a frame that cannot be read");
    }
    if (frame.forward().kind() == v1::FORWARD_KIND_SNAPSHOT_END) ready_ = true;
    if (frame.has_ack()) acked_ = std::max(acked_, frame.ack().through_seq());
    if (frame.has_reject()) Fail("rejected: " + frame.reject().detail());
  }
  void OnSent() override {}
  void OnEnded(const link::StreamEnd& end) override { Fail(end.message); }

  const PeerSetup setup_;
  link::GrpcConnection connection_;
};

/// MQTT 3.1.1 at QoS 0 or 1.
class MqttPeer final : public ByteClient {
 public:
  MqttPeer(link::Loop& loop, link::LinkOptions options, const PeerSetup& setup)
      : ByteClient(loop, std::move(options)),
        setup_(setup),
        acknowledges_(setup.fan_out.protocol == FanOutProtocol::kMqttQos1) {}

  void Send(std::size_t messages) override {
    const FanOut& fan_out = setup_.fan_out;
    for (std::size_t i = 0; i < messages; ++i) {
      const Update update{.number = ++sent_, .at = fan_out.clock.Steady()};
      std::string body;
      AppendMqttText(body, kTopic);
      if (acknowledges_) {
        if (++packet_ == 0) packet_ = 1;
        AppendMqttNumber(body, packet_);
      }
      body += ForwardOf(update, fan_out.origin_ruri);
      std::string packet(1, acknowledges_ ? kMqttPublishQos1 : kMqttPublish);
      AppendMqttLength(packet, body.size());
      Write(packet + body);
    }
  }

 private:
  void Greet() override { Write(MqttConnectPacket(setup_.name())); }
  void TakeAnswers(std::string& in) override {
    std::string_view rest = in;
    MqttPacket packet = ReadMqttPacket(rest);
    for (; packet.state == MqttPacket::State::kWhole; packet = ReadMqttPacket(rest)) {
      Take(packet);
      rest.remove_prefix(packet.bytes);
    }
    if (packet.state == MqttPacket::State::kMalformed) Fail("a packet that cannot be read");
    in.erase(0, in.size() - rest.size());
    if (!acknowledgements_.empty()) Write(acknowledgements_);
    acknowledgements_.clear();
  }
  void Take(const MqttPacket& packet) {
    if (packet.head == kMqttConnack && setup_.publishes()) ready_ = true;
    if (packet.head == kMqttConnack && !setup_.publishes()) {
      Write(MqttSubscribePacket(kTopic, acknowledges_ ? 1 : 0));
    }
    if (packet.head == kMqttSuback) ready_ = true;
    if (packet.head == kMqttPuback) ++acked_;
    const std::optional<MqttMessage> message = ReadMqttPublish(packet);
    if (!message) return;
    setup_.fan_out.deliveries.Note(message->payload);
    if (!message->packet) return;
    acknowledgements_ += kMqttPuback;
    AppendMqttLength(acknowledgements_, sizeof *message->packet);
    AppendMqttNumber(acknowledgements_, *message->packet);
  }

  const PeerSetup setup_;
  const bool acknowledges_;
  std::uint16_t packet_ = 0;
  std::string acknowledgements_;
};

/// NATS core.
class NatsPeer final : public ByteClient {
 public:
  NatsPeer(link::Loop& loop, link::LinkOptions options, const PeerSetup& setup)
      : ByteClient(loop, std::move(options)), setup_(setup) {}

  void Send(std::size_t messages) override {
    const FanOut& fan_out = setup_.fan_out;
    for (std::size_t i = 0; i < messages; ++i) {
      const Update update{.number = ++sent_, .at = fan_out.clock.Steady()};
      const std::string payload = ForwardOf(update, fan_out.origin_ruri);
      Write(fmt::format("PUB {} {}\r\n", kTopic, payload.size()) + payload + "\r\n");
    }
  }

 private:
  void Greet() override {
    std::string hello = "CONNECT {\"verbose\":false,\"pedantic\":false}\r\n";
    if (!setup_.publishes()) hello += fmt::format("SUB {} 1\r\n", kTopic);
    Write(hello + "PING\r\n");
  }
  void TakeAnswers(std::string& in) override {
    std::string_view rest = in;
    for (NatsSaid said = ReadNats(rest); said.kind != NatsSaid::Kind::kPartial;
         said = ReadNats(rest)) {
      Take(said);
      if (failed_) break;
      rest.remove_prefix(said.bytes);
    }
    in.erase(0, in.size() - rest.size());
  }
  void Take(const NatsSaid& said) {
    switch (said.kind) {
      case NatsSaid::Kind::kMessage:
        setup_.fan_out.deliveries.Note(said.text);
        return;
      case NatsSaid::Kind::kPing:
        return Write("PONG\r\n");
      case NatsSaid::Kind::kPong:
        ready_ = true;
        return;
      case NatsSaid::Kind::kError:
        return Fail(std::string(said.text));
      case NatsSaid::Kind::kMalformed:
        return Fail("a message that cannot be read");
      case NatsSaid::Kind::kPartial:
      case NatsSaid::Kind::kOther:
        return;
    }
  }

  const PeerSetup setup_;
};

}  // namespace

std::unique_ptr<Client> ConnectPeer(const FanOut& fan_out, FanOutRole role, link::Loop& loop,
                                    link::LinkOptions options, std::size_t number) {
  const PeerSetup setup{.fan_out = fan_out, .role = role, .number = number};
  switch (fan_out.protocol) {
    case FanOutProtocol::kRelay:
      return std::make_unique<RelayPeer>(loop, std::move(options), setup);
    case FanOutProtocol::kMqttQos0:
    case FanOutProtocol::kMqttQos1:
      return std::make_unique<MqttPeer>(loop, std::move(options), setup);
    case FanOutProtocol::kNats:
      options.greeted_in_clear = true;
      return std::make_unique<NatsPeer>(loop, std::move(options), setup);
  }
  return nullptr;
}

}  // namespace uplink::bench
