#include "server/mqtt/decode.h"

#include <algorithm>

#include "schema/base/utf8.h"
#include "server/mqtt/byte_reader.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/properties.h"
#include "server/mqtt/reason_codes.h"

namespace uplink::mqtt {
namespace {

constexpr unsigned kRetainFlag = 0x01;
constexpr unsigned kQosFlags = 0x06;
constexpr unsigned kQos2Flag = 0x04;
constexpr unsigned kDupFlag = 0x08;

constexpr Fault kEndsEarly{EndReason::kMalformed, "the packet is shorter than what it must have"};
constexpr Fault kGoesOn{EndReason::kMalformed, "bytes follow the packet's last field"};

std::optional<Fault> CheckPublishFlags(std::uint8_t first) {
  const unsigned qos = first & kQosFlags;
  if (qos == kQosFlags) return Fault{EndReason::kMalformed, "PUBLISH with both bits of QoS"};
  if (qos == kQos2Flag) return Fault{EndReason::kQos2, "PUBLISH at QoS 2, which we never ask for"};
  if (qos == 0 && (first & kDupFlag) != 0) {
    return Fault{EndReason::kMalformed, "PUBLISH at QoS 0 with DUP"};  // [MQTT-3.3.1-2]
  }
  return std::nullopt;
}

/// [MQTT-1.5.4-1], [MQTT-3.3.2-1], [MQTT-3.3.2-2]; an empty topic stands for an alias, and there
/// are none.
bool IsTopic(std::string_view text) {
  return !text.empty() && text.find_first_of("+#") == std::string_view::npos && IsCleanUtf8(text);
}

/// Properties of an answer, if the version has them; none if the packet ends before them.
Decoded<Properties> PropertiesOf(Version version, PacketType type, ByteReader& from) {
  if (version == Version::k311) return Properties{};
  return ReadProperties(type, from);
}

Decoded<Packet> DecodeConnack(Version version, std::string_view body) {
  ByteReader from(body);
  const auto flags = from.Number<1>();
  const auto code = from.Number<1>();
  if (!flags || !code) return kEndsEarly;
  if (*flags > 1) return Fault{EndReason::kMalformed, "CONNACK with flags that it cannot have"};
  const bool present = *flags == 1;
  if (present && *code != 0) {  // [MQTT-3.2.2-6]
    return Fault{EndReason::kMalformed, "CONNACK refuses, and has a session"};
  }
  // A broker with only 3.1.1 refuses MQTT 5 in its own form, without properties.
  const bool in_form_of_311 = from.empty() && IsRefusalOf311(static_cast<std::uint8_t>(*code));
  const auto found =
      PropertiesOf(in_form_of_311 ? Version::k311 : version, PacketType::kConnack, from);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  if (!from.empty()) return kGoesOn;
  const auto& properties = std::get<Properties>(found);
  return Connack{.session_present = present,
                 .code = static_cast<std::uint8_t>(*code),
                 .server_keepalive_seconds = properties.server_keepalive_seconds,
                 .session_expiry_seconds = properties.session_expiry_seconds,
                 .packet_bytes_max = properties.packet_bytes_max,
                 .reason = properties.reason};
}

/// SUBACK or UNSUBACK, which differ only in their codes.
struct AskAnswer {
  PacketId id = 0;
  std::string_view codes;
};

Decoded<AskAnswer> DecodeAskAnswer(Version version, PacketType type, std::string_view body) {
  ByteReader from(body);
  const auto id = from.Number<2>();
  if (!id) return kEndsEarly;
  if (*id == 0) return Fault{EndReason::kMalformed, "an answer with packet id 0"};
  const auto found = PropertiesOf(version, type, from);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  return AskAnswer{static_cast<PacketId>(*id), from.rest()};
}

Decoded<Packet> DecodeSuback(Version version, std::string_view body) {
  const auto found = DecodeAskAnswer(version, PacketType::kSuback, body);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  const auto& answer = std::get<AskAnswer>(found);
  if (answer.codes.empty()) return kEndsEarly;
  const bool valid = std::ranges::all_of(answer.codes, [version](char each) {
    const auto code = static_cast<unsigned char>(each);
    return code <= 2 || (version == Version::k311 ? code == 0x80 : code >= 0x80);
  });
  if (!valid) return Fault{EndReason::kMalformed, "SUBACK with a code that it cannot have"};
  return Suback{answer.id, answer.codes};
}

Decoded<Packet> DecodeUnsuback(Version version, std::string_view body) {
  const auto found = DecodeAskAnswer(version, PacketType::kUnsuback, body);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  const auto& answer = std::get<AskAnswer>(found);
  if (version == Version::k311 && !answer.codes.empty()) return kGoesOn;
  if (version == Version::k5 && answer.codes.empty()) return kEndsEarly;
  return Unsuback{answer.id, answer.codes};
}

/// Only in MQTT 5. It may end after each of its parts.
Decoded<Packet> DecodeDisconnect(std::string_view body) {
  ByteReader from(body);
  const auto code = from.Number<1>();
  if (!code) return Disconnect{};
  if (from.empty()) return Disconnect{.code = static_cast<std::uint8_t>(*code)};
  const auto found = ReadProperties(PacketType::kDisconnect, from);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  if (!from.empty()) return kGoesOn;
  return Disconnect{static_cast<std::uint8_t>(*code), std::get<Properties>(found).reason};
}

}  // namespace

std::optional<Fault> CheckFixedHeader(Version version, const FixedHeader& fixed) {
  if (fixed.is_publish()) return CheckPublishFlags(fixed.first);
  switch (static_cast<PacketType>(fixed.first >> 4U)) {
    case PacketType::kDisconnect:
      if (version == Version::k5) break;
      return Fault{EndReason::kUnexpectedPacket, "DISCONNECT, which 3.1.1 has from clients alone"};
    case PacketType::kConnack:
    case PacketType::kSuback:
    case PacketType::kUnsuback:
    case PacketType::kPingresp:
      break;
    case PacketType::kConnect:
    case PacketType::kPublish:
    case PacketType::kPuback:
    case PacketType::kSubscribe:
    case PacketType::kUnsubscribe:
    case PacketType::kPingreq:
    default:  // a byte of a peer may name any type
      return Fault{EndReason::kUnexpectedPacket, "a packet that no broker sends to a subscriber"};
  }
  if ((fixed.first & 0x0FU) != 0) {
    return Fault{EndReason::kMalformed, "an answer with flags that it cannot have"};
  }
  if (fixed.remaining > kAnswerBytesMax) {
    return Fault{EndReason::kTooLarge, "an answer over 128 KiB"};
  }
  return std::nullopt;
}

Decoded<HeadExtent> ExtentOfHead(Version version, const FixedHeader& fixed,
                                 std::string_view begin) {
  constexpr Fault kPast{EndReason::kMalformed, "a PUBLISH's head ends past its packet"};
  constexpr std::size_t kLengthBytes = 2;
  constexpr std::size_t kDigitsMax = 4;
  const std::size_t remaining = fixed.remaining;
  ByteReader from(begin);
  const auto topic = from.Number<kLengthBytes>();
  if (!topic)
    return remaining < kLengthBytes ? Decoded<HeadExtent>(kPast) : HeadExtent{kLengthBytes};
  const std::size_t id_bytes = fixed.qos() == Qos::kAtMostOnce ? 0 : sizeof(PacketId);
  const std::size_t before = kLengthBytes + *topic + id_bytes;
  if (before > remaining) return kPast;
  if (version == Version::k311) return HeadExtent{before, true};
  if (begin.size() <= before) {
    return before == remaining ? Decoded<HeadExtent>(kPast) : HeadExtent{before + 1};
  }
  ByteReader behind(begin.substr(before));
  const std::size_t there = behind.rest().size();
  const auto properties = behind.Length();
  if (!properties) {
    if (there >= kDigitsMax) {
      return Fault{EndReason::kMalformed, "the length of properties has five digits"};
    }
    if (begin.size() == remaining) return kPast;
    return HeadExtent{begin.size() + 1};
  }
  const std::size_t bytes = before + (there - behind.rest().size()) + *properties;
  if (bytes > remaining) return kPast;
  if (bytes > kHeadBytesMax) return HeadExtent{before, true, true};
  return HeadExtent{bytes, true};
}

Decoded<Publish> DecodePublishHead(Version version, const FixedHeader& fixed,
                                   const HeadExtent& extent, std::string_view head) {
  Publish message{.qos = fixed.qos(),
                  .dup = (fixed.first & kDupFlag) != 0,
                  .retained = (fixed.first & kRetainFlag) != 0,
                  .head_unread = extent.too_large};
  ByteReader from(head);
  const auto topic = from.Field();
  if (!topic) return kEndsEarly;
  message.topic = *topic;
  message.bad_topic = !IsTopic(*topic);
  if (message.qos == Qos::kAtLeastOnce) {
    const auto id = from.Number<2>();
    if (!id) return kEndsEarly;
    if (*id == 0) return Fault{EndReason::kMalformed, "a PUBLISH at QoS 1 with packet id 0"};
    message.id = static_cast<PacketId>(*id);
  }
  if (extent.too_large) return message;
  const auto found = PropertiesOf(version, PacketType::kPublish, from);
  if (const auto* fault = std::get_if<Fault>(&found)) return *fault;
  if (!from.empty()) return kGoesOn;
  const auto& properties = std::get<Properties>(found);
  if (properties.correlation.size() <= kCorrelationBytesMax) {
    message.correlation = properties.correlation;
  }
  message.has_response_topic = properties.has_response_topic;
  return message;
}

Decoded<Packet> DecodeAnswer(Version version, const FixedHeader& fixed, std::string_view body) {
  switch (static_cast<PacketType>(fixed.first >> 4U)) {
    case PacketType::kConnack:
      return DecodeConnack(version, body);
    case PacketType::kSuback:
      return DecodeSuback(version, body);
    case PacketType::kUnsuback:
      return DecodeUnsuback(version, body);
    case PacketType::kPingresp:
      if (!body.empty()) return kGoesOn;
      return Pingresp{};
    case PacketType::kDisconnect:
      return DecodeDisconnect(body);
    case PacketType::kConnect:
    case PacketType::kPublish:
    case PacketType::kPuback:
    case PacketType::kSubscribe:
    case PacketType::kUnsubscribe:
    case PacketType::kPingreq:
      break;
  }
  return Fault{EndReason::kUnexpectedPacket, "a packet that no broker sends to a subscriber"};
}

}  // namespace uplink::mqtt
