#include "server/mqtt/encode.h"

#include "schema/base/check.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/property_ids.h"

namespace uplink::mqtt {
namespace {

// Flags of CONNECT.
constexpr unsigned kCleanFlag = 0x02;
constexpr unsigned kPasswordFlag = 0x40;
constexpr unsigned kUsernameFlag = 0x80;
/// Options of a filter in MQTT 5: no retained messages when we subscribe.
constexpr unsigned kNoRetained = 0x20;
/// SUBSCRIBE and UNSUBSCRIBE have this in the lower half of their first byte.
constexpr unsigned kAskFlags = 0x02;

void AddByte(std::string& to, unsigned byte) { to.push_back(static_cast<char>(byte)); }

void AddU16(std::string& to, unsigned number) {
  AddByte(to, number >> 8U);
  AddByte(to, number & 0xFFU);
}

void AddU32(std::string& to, std::uint32_t number) {
  AddU16(to, number >> 16U);
  AddU16(to, number & 0xFFFFU);
}

void AddLength(std::string& to, std::size_t length) {
  UPLINK_CHECK(length <= kRemainingLengthMax, "a packet is larger than MQTT can say");
  do {
    const auto digit = static_cast<unsigned>(length & 0x7FU);
    length >>= 7U;
    AddByte(to, length > 0 ? digit | 0x80U : digit);
  } while (length > 0);
}

void AddField(std::string& to, std::string_view field) {
  UPLINK_CHECK(field.size() <= kFieldBytesMax, "a field is longer than MQTT can say");
  AddU16(to, static_cast<unsigned>(field.size()));
  to.append(field);
}

void AddProperties(std::string& to, std::string_view properties) {
  AddLength(to, properties.size());
  to.append(properties);
}

std::string Framed(PacketType type, unsigned flags, std::string_view body) {
  std::string packet;
  packet.reserve(body.size() + 5);
  AddByte(packet, static_cast<unsigned>(type) << 4U | flags);
  AddLength(packet, body.size());
  packet.append(body);
  return packet;
}

std::string ConnectProperties(const Connect& connect) {
  std::string properties;
  if (connect.session_expiry_seconds) {
    AddByte(properties, kSessionExpiry);
    AddU32(properties, *connect.session_expiry_seconds);
  }
  if (connect.receive_maximum) {
    AddByte(properties, kReceiveMaximum);
    AddU16(properties, *connect.receive_maximum);
  }
  if (connect.packet_bytes_max) {
    AddByte(properties, kMaximumPacketSize);
    AddU32(properties, *connect.packet_bytes_max);
  }
  return properties;
}

}  // namespace

std::string EncodeConnect(const Connect& connect) {
  std::string body;
  AddField(body, "MQTT");
  AddByte(body, connect.version == Version::k5 ? 5 : 4);
  AddByte(body, (connect.clean ? kCleanFlag : 0) | (connect.username ? kUsernameFlag : 0) |
                    (connect.password ? kPasswordFlag : 0));
  AddU16(body, connect.keepalive_seconds);
  if (connect.version == Version::k5) AddProperties(body, ConnectProperties(connect));
  AddField(body, connect.client_id);
  if (connect.username) AddField(body, *connect.username);
  if (connect.password) AddField(body, *connect.password);
  return Framed(PacketType::kConnect, 0, body);
}

std::string EncodeSubscribe(Version version, PacketId id, std::span<const Filter> filters) {
  const unsigned options = version == Version::k5 ? kNoRetained : 0;
  std::string body;
  AddU16(body, id);
  if (version == Version::k5) AddProperties(body, {});
  for (const Filter& filter : filters) {
    AddField(body, filter.topic);
    AddByte(body, options | static_cast<unsigned>(filter.qos));
  }
  return Framed(PacketType::kSubscribe, kAskFlags, body);
}

std::string EncodeUnsubscribe(Version version, PacketId id, std::span<const std::string> topics) {
  std::string body;
  AddU16(body, id);
  if (version == Version::k5) AddProperties(body, {});
  for (const std::string& topic : topics) AddField(body, topic);
  return Framed(PacketType::kUnsubscribe, kAskFlags, body);
}

std::string EncodePuback(PacketId id) {
  std::string body;
  AddU16(body, id);
  return Framed(PacketType::kPuback, 0, body);
}

std::string EncodePublish(Version version, const Outgoing& message) {
  std::string body;
  body.reserve(message.topic.size() + message.correlation.size() + message.payload.size() + 16);
  AddField(body, message.topic);
  if (version == Version::k5) {
    std::string properties;
    if (!message.correlation.empty()) {
      AddByte(properties, kCorrelationData);
      AddField(properties, message.correlation);
    }
    AddProperties(body, properties);
  }
  body.append(message.payload);
  return Framed(PacketType::kPublish, 0, body);
}

std::string EncodePingreq() { return Framed(PacketType::kPingreq, 0, {}); }

std::string EncodeDisconnect(Version version, std::uint8_t code) {
  std::string body;
  if (version == Version::k5 && code != 0) AddByte(body, code);
  return Framed(PacketType::kDisconnect, 0, body);
}

}  // namespace uplink::mqtt
