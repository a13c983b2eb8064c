#include "tests/bench/load/mqtt.h"

#include <algorithm>

namespace uplink::bench {
namespace {

constexpr std::size_t kNumberBytes = 2;
/// Of a packet's length.
constexpr std::size_t kLengthBytesMax = 4;
constexpr unsigned kByteBits = 8;
constexpr unsigned kLengthBits = 7;
constexpr std::uint8_t kLengthMore = 1U << kLengthBits;
constexpr std::uint8_t kTypeBits = 0xF0;
constexpr std::uint8_t kQosBits = 0x06;
constexpr std::uint8_t kQos1 = 0x02;

std::uint8_t ByteAt(std::string_view in, std::size_t at) {
  return static_cast<std::uint8_t>(in[at]);
}

/// Takes a number from the front, which has as many bytes.
std::uint16_t TakeNumber(std::string_view& in) {
  const unsigned number = (unsigned{ByteAt(in, 0)} << kByteBits) | ByteAt(in, 1);
  in.remove_prefix(kNumberBytes);
  return static_cast<std::uint16_t>(number);
}

std::string Packet(char head, std::string_view body) {
  std::string packet(1, head);
  AppendMqttLength(packet, body.size());
  return packet.append(body);
}

}  // namespace

void AppendMqttNumber(std::string& to, std::uint16_t number) {
  to += static_cast<char>(number >> kByteBits);
  to += static_cast<char>(number);
}

void AppendMqttText(std::string& to, std::string_view text) {
  AppendMqttNumber(to, static_cast<std::uint16_t>(text.size()));
  to.append(text);
}

void AppendMqttLength(std::string& to, std::size_t length) {
  for (; length >= kLengthMore; length >>= kLengthBits) {
    to += static_cast<char>(length % kLengthMore + kLengthMore);
  }
  to += static_cast<char>(length);
}

std::string MqttConnectPacket(std::string_view client) {
  std::string body;
  AppendMqttText(body, "MQTT");
  // Version 3.1.1, a clean session, no keepalive.
  body.append({4, 2, 0, 0});
  AppendMqttText(body, client);
  return Packet(kMqttConnect, body);
}

std::string MqttSubscribePacket(std::string_view topic, std::uint8_t qos) {
  std::string body;
  AppendMqttNumber(body, 1);
  AppendMqttText(body, topic);
  body += static_cast<char>(qos);
  return Packet(kMqttSubscribe, body);
}

MqttPacket ReadMqttPacket(std::string_view in) {
  MqttPacket packet;
  std::size_t length = 0;
  for (std::size_t i = 0;; ++i) {
    if (i == kLengthBytesMax) return {.state = MqttPacket::State::kMalformed};
    if (in.size() < 1 + i + 1) return packet;
    const std::uint8_t byte = ByteAt(in, 1 + i);
    length |= static_cast<std::size_t>(byte % kLengthMore) << (kLengthBits * i);
    if (byte >= kLengthMore) continue;
    packet.bytes = 1 + i + 1 + length;
    break;
  }
  if (in.size() < packet.bytes) return packet;
  packet.state = MqttPacket::State::kWhole;
  packet.head = in[0];
  packet.body = in.substr(packet.bytes - length, length);
  return packet;
}

std::optional<MqttMessage> ReadMqttPublish(const MqttPacket& packet) {
  const auto head = static_cast<std::uint8_t>(packet.head);
  const unsigned qos = head & kQosBits;
  if ((head & kTypeBits) != kMqttPublish || qos > kQos1) return std::nullopt;
  std::string_view in = packet.body;
  if (in.size() < kNumberBytes) return std::nullopt;
  const std::size_t topic_bytes = TakeNumber(in);
  if (in.size() < topic_bytes) return std::nullopt;
  MqttMessage message{.topic = in.substr(0, topic_bytes), .packet = {}, .payload = {}};
  in.remove_prefix(topic_bytes);
  if (qos == kQos1) {
    if (in.size() < kNumberBytes) return std::nullopt;
    message.packet = TakeNumber(in);
  }
  message.payload = in;
  return message;
}

}  // namespace uplink::bench
