#include "tests/bench/load/byte_client.h"

#include <cstring>

#include <fmt/core.h>

#include "tests/bench/load/mqtt.h"
#include "tests/bench/load/relay_client.h"
#include "tests/bench/sink_protocol.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kMqttAnswerBytes = 4;
constexpr std::uint64_t kNatsMessagesAPing = 64;

}  // namespace

std::unique_ptr<Client> Connect(Protocol protocol, link::Loop& loop, link::LinkOptions options,
                                std::size_t number) {
  switch (protocol) {
    case Protocol::kRelay:
      return std::make_unique<RelayClient>(loop, std::move(options), number);
    case Protocol::kLengthPrefix:
      return std::make_unique<LengthPrefixClient>(loop, std::move(options));
    case Protocol::kMqtt:
      return std::make_unique<MqttClient>(loop, std::move(options), number);
    case Protocol::kNats:
      options.greeted_in_clear = true;
      return std::make_unique<NatsClient>(loop, std::move(options), number);
  }
  return nullptr;
}

void LengthPrefixClient::Send(std::size_t messages) {
  out_.assign(sizeof(SinkFrame), '\0');
  for (std::size_t i = 0; i < messages; ++i) out_.append(Payload(++sent_));
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

MqttClient::MqttClient(link::Loop& loop, link::LinkOptions options, std::size_t number)
    : ByteClient(loop, std::move(options)), name_(fmt::format("robot-{}", number)) {}

void MqttClient::Greet() { Write(MqttConnectPacket(name_)); }

void MqttClient::Send(std::size_t messages) {
  out_.clear();
  for (std::size_t i = 0; i < messages; ++i) {
    const std::string& payload = Payload(++sent_);
    if (++packet_ == 0) packet_ = 1;
    out_ += kMqttPublishQos1;
    AppendMqttLength(out_, 2 + name_.size() + 2 + payload.size());
    AppendMqttText(out_, name_);
    AppendMqttNumber(out_, packet_);
    out_.append(payload);
  }
  Write(out_);
}

void MqttClient::TakeAnswers(std::string& in) {
  std::size_t at = 0;
  for (; in.size() - at >= kMqttAnswerBytes; at += kMqttAnswerBytes) {
    if (in[at] == kMqttConnack) ready_ = true;
    if (in[at] == kMqttPuback) ++acked_;
  }
  in.erase(0, at);
}

NatsClient::NatsClient(link::Loop& loop, link::LinkOptions options, std::size_t number)
    : ByteClient(loop, std::move(options)), subject_(fmt::format("robot.{}", number)) {}

void NatsClient::Greet() { Write("CONNECT {\"verbose\":false,\"pedantic\":false}\r\nPING\r\n"); }

void NatsClient::Send(std::size_t messages) {
  out_.clear();
  for (std::size_t i = 0; i < messages; ++i) {
    const std::string& payload = Payload(++sent_);
    out_ += fmt::format("PUB {} {}\r\n", subject_, payload.size());
    out_.append(payload).append("\r\n");
    if (sent_ % kNatsMessagesAPing == 0) out_ += "PING\r\n";
  }
  Write(out_);
}

void NatsClient::TakeAnswers(std::string& in) {
  for (std::size_t end = 0; (end = in.find("\r\n")) != std::string::npos; in.erase(0, end + 2)) {
    const std::string_view line(in.data(), end);
    if (line == "PING") Write("PONG\r\n");
    if (line.starts_with("-ERR")) Fail(std::string(line));
    if (line != "PONG") continue;
    if (ready_) acked_ += kNatsMessagesAPing;
    ready_ = true;
  }
}

}  // namespace uplink::bench
