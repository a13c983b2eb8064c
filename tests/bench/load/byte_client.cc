#include "tests/bench/load/byte_client.h"

#include <cstring>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "tests/bench/load/relay_client.h"
#include "tests/bench/sink_protocol.h"

namespace uplink::bench {
namespace {

constexpr std::uint64_t kNatsMessagesAPing = 64;

}  // namespace

std::unique_ptr<Client> Connect(Protocol protocol, link::Loop& loop, link::LinkOptions options,
                                ClientStyle style) {
  switch (protocol) {
    case Protocol::kRelay:
      return std::make_unique<RelayClient>(loop, std::move(options), std::move(style));
    case Protocol::kLengthPrefix:
      return std::make_unique<LengthPrefixClient>(loop, std::move(options), std::move(style));
    case Protocol::kMqtt:
    case Protocol::kMqttQos0:
      return std::make_unique<MqttClient>(loop, std::move(options), std::move(style),
                                          protocol == Protocol::kMqtt);
    case Protocol::kNats:
      options.greeted_in_clear = true;
      return std::make_unique<NatsClient>(loop, std::move(options), std::move(style));
  }
  return nullptr;
}

void LengthPrefixClient::Send(std::size_t messages) {
  out_.assign(sizeof(SinkFrame), '\0');
  for (std::size_t i = 0; i < messages; ++i) out_.append(NextPayload());
  const SinkFrame head{.bytes = static_cast<std::uint32_t>(out_.size() - sizeof(SinkFrame)),
                       .messages = static_cast<std::uint32_t>(messages)};
  std::memcpy(out_.data(), &head, sizeof head);
  Write(out_);
}

void LengthPrefixClient::TakeAnswers(std::string& in) {
  while (in.size() >= sizeof(SinkAck)) {
    SinkAck ack;
    std::memcpy(&ack, in.data(), sizeof ack);
    acked_ = ack.messages;
    in.erase(0, sizeof ack);
  }
}

void MqttClient::Greet() { Write(MqttConnectPacket(style().name)); }

void MqttClient::Send(std::size_t messages) {
  out_.clear();
  const std::string& topic = style().topic;
  for (std::size_t i = 0; i < messages; ++i) {
    const std::string& payload = NextPayload();
    out_ += acknowledges_ ? kMqttPublishQos1 : kMqttPublish;
    AppendMqttLength(out_, 2 + topic.size() + (acknowledges_ ? 2 : 0) + payload.size());
    AppendMqttText(out_, topic);
    if (acknowledges_) {
      if (++packet_ == 0) packet_ = 1;
      AppendMqttNumber(out_, packet_);
    }
    out_.append(payload);
  }
  Write(out_);
}

void MqttClient::TakeAnswers(std::string& in) {
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

void MqttClient::Take(const MqttPacket& packet) {
  if (packet.head == kMqttConnack && style().receives) {
    Write(MqttSubscribePacket(style().topic, acknowledges_ ? 1 : 0));
  } else if (packet.head == kMqttConnack || packet.head == kMqttSuback) {
    ready_ = true;
  }
  if (packet.head == kMqttPuback) ++acked_;
  const std::optional<MqttMessage> message = ReadMqttPublish(packet);
  if (!message) return;
  if (style().takes) style().takes(message->payload);
  if (!message->packet) return;
  acknowledgements_ += kMqttPuback;
  AppendMqttLength(acknowledgements_, sizeof *message->packet);
  AppendMqttNumber(acknowledgements_, *message->packet);
}

void NatsClient::Greet() {
  std::string hello = "CONNECT {\"verbose\":false,\"pedantic\":false}\r\n";
  if (style().receives) hello += fmt::format("SUB {} 1\r\n", style().topic);
  Write(hello + "PING\r\n");
}

void NatsClient::Send(std::size_t messages) {
  out_.clear();
  for (std::size_t i = 0; i < messages; ++i) {
    const std::string& payload = NextPayload();
    out_ += fmt::format("PUB {} {}\r\n", style().topic, payload.size());
    out_.append(payload).append("\r\n");
    if (sent_ % kNatsMessagesAPing == 0) out_ += "PING\r\n";
  }
  Write(out_);
}

void NatsClient::TakeAnswers(std::string& in) {
  std::string_view rest = in;
  for (NatsSaid said = ReadNats(rest); said.kind != NatsSaid::Kind::kPartial;
       said = ReadNats(rest)) {
    Take(said);
    if (failed_) break;
    rest.remove_prefix(said.bytes);
  }
  in.erase(0, in.size() - rest.size());
}

void NatsClient::Take(const NatsSaid& said) {
  switch (said.kind) {
    case NatsSaid::Kind::kMessage:
      if (style().takes) style().takes(said.text);
      return;
    case NatsSaid::Kind::kPing:
      return Write("PONG\r\n");
    case NatsSaid::Kind::kPong:
      if (ready_) acked_ += kNatsMessagesAPing;
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

}  // namespace uplink::bench
