#include "server/mqtt/properties.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <iterator>

#include "schema/base/utf8.h"
#include "server/mqtt/property_ids.h"

namespace uplink::mqtt {
namespace {

enum class Kind : std::uint8_t {
  kSwitch,   // a byte, 0 or 1
  kU16,      // any
  kU16Some,  // not 0
  kU32,      // any
  kU32Some,  // not 0
  kLength,   // a length, not 0
  kText,
  kBinary,
  kPair,  // two texts
};

// The packets that may have it.
constexpr unsigned kInConnack = 1;
constexpr unsigned kInPublish = 2;
constexpr unsigned kInAnswer = 4;  // SUBACK, UNSUBACK
constexpr unsigned kInDisconnect = 8;
constexpr unsigned kInAll = kInConnack | kInPublish | kInAnswer | kInDisconnect;

struct Property {
  std::uint8_t id;
  Kind kind;
  unsigned packets;
};

constexpr Property kProperties[] = {
    {kPayloadFormat, Kind::kSwitch, kInPublish},
    {kMessageExpiry, Kind::kU32, kInPublish},
    {kContentType, Kind::kText, kInPublish},
    {kResponseTopic, Kind::kText, kInPublish},
    {kCorrelationData, Kind::kBinary, kInPublish},
    {kSubscriptionId, Kind::kLength, kInPublish},
    {kSessionExpiry, Kind::kU32, kInConnack},
    {kAssignedClientId, Kind::kText, kInConnack},
    {kServerKeepalive, Kind::kU16, kInConnack},
    {kAuthMethod, Kind::kText, kInConnack},
    {kAuthData, Kind::kBinary, kInConnack},
    {kResponseInformation, Kind::kText, kInConnack},
    {kServerReference, Kind::kText, kInConnack | kInDisconnect},
    {kReasonString, Kind::kText, kInConnack | kInAnswer | kInDisconnect},
    {kReceiveMaximum, Kind::kU16Some, kInConnack},
    {kTopicAliasMaximum, Kind::kU16, kInConnack},
    {kTopicAlias, Kind::kU16, kInPublish},
    {kMaximumQos, Kind::kSwitch, kInConnack},
    {kRetainAvailable, Kind::kSwitch, kInConnack},
    {kUserProperty, Kind::kPair, kInAll},
    {kMaximumPacketSize, Kind::kU32Some, kInConnack},
    {kWildcardAvailable, Kind::kSwitch, kInConnack},
    {kSubscriptionIdAvailable, Kind::kSwitch, kInConnack},
    {kSharedAvailable, Kind::kSwitch, kInConnack},
};

/// The range of identifiers in the table.
constexpr std::size_t kIds = 0x2B;

/// 0 for packets that have none.
unsigned FlagOf(PacketType packet) {
  switch (packet) {
    case PacketType::kConnack:
      return kInConnack;
    case PacketType::kPublish:
      return kInPublish;
    case PacketType::kSuback:
    case PacketType::kUnsuback:
      return kInAnswer;
    case PacketType::kDisconnect:
      return kInDisconnect;
    case PacketType::kConnect:
    case PacketType::kPuback:
    case PacketType::kSubscribe:
    case PacketType::kUnsubscribe:
    case PacketType::kPingreq:
    case PacketType::kPingresp:
      return 0;
  }
  return 0;
}

/// A property's value: a number, or its field's content, for a pair the second field.
struct Value {
  std::uint32_t number = 0;
  std::string_view field;
  std::string_view name;
};

std::optional<Value> NumberIn(std::optional<std::uint32_t> number) {
  return number ? std::optional(Value{.number = *number}) : std::nullopt;
}

std::optional<Value> FieldIn(std::optional<std::string_view> field) {
  return field ? std::optional(Value{.field = *field}) : std::nullopt;
}

/// Reads a value by its form alone; empty if the bytes end too early.
std::optional<Value> ValueIn(Kind kind, ByteReader& from) {
  switch (kind) {
    case Kind::kSwitch:
      return NumberIn(from.Number<1>());
    case Kind::kU16:
    case Kind::kU16Some:
      return NumberIn(from.Number<2>());
    case Kind::kU32:
    case Kind::kU32Some:
      return NumberIn(from.Number<4>());
    case Kind::kLength:
      return NumberIn(from.Length());
    case Kind::kText:
    case Kind::kBinary:
      return FieldIn(from.Field());
    case Kind::kPair: {
      const auto name = from.Field();
      auto value = name ? FieldIn(from.Field()) : std::nullopt;
      if (value) value->name = *name;
      return value;
    }
  }
  return std::nullopt;
}

/// Whether MQTT 5 allows this value.
bool IsValid(Kind kind, const Value& value) {
  switch (kind) {
    case Kind::kSwitch:
      return value.number <= 1;
    case Kind::kU16Some:
    case Kind::kU32Some:
    case Kind::kLength:
      return value.number > 0;
    case Kind::kText:
      return IsCleanUtf8(value.field);
    case Kind::kPair:
      return IsCleanUtf8(value.name) && IsCleanUtf8(value.field);
    case Kind::kU16:
    case Kind::kU32:
    case Kind::kBinary:
      return true;
  }
  return false;
}

void Keep(std::uint8_t id, const Value& value, Properties& in) {
  if (id == kServerKeepalive) {
    in.server_keepalive_seconds = static_cast<std::uint16_t>(value.number);
  }
  if (id == kSessionExpiry) in.session_expiry_seconds = value.number;
  if (id == kMaximumPacketSize) in.packet_bytes_max = value.number;
  if (id == kReasonString) in.reason = value.field;
  if (id == kCorrelationData) in.correlation = value.field;
  if (id == kResponseTopic) in.has_response_topic = true;
}

}  // namespace

Decoded<Properties> ReadProperties(PacketType packet, ByteReader& from) {
  const auto length = from.Length();
  const auto bytes = length ? from.Bytes(*length) : std::nullopt;
  if (!bytes) return Fault{EndReason::kMalformed, "the properties end past their packet"};
  // A broker may pass on invented properties, and would deliver them again for ever.
  const bool judged = packet != PacketType::kPublish;
  Properties found;
  std::bitset<kIds> seen;
  for (ByteReader rest(*bytes); !rest.empty();) {
    // An identifier has the form of a length; all known ones have one digit.
    const auto id = rest.Number<1>();
    const auto* const known = std::ranges::find(kProperties, *id, &Property::id);
    if (known == std::end(kProperties)) {
      return Fault{EndReason::kUnknownProperty, "a property that MQTT 5 does not have"};
    }
    if (judged && (known->packets & FlagOf(packet)) == 0) {
      return Fault{EndReason::kMalformed, "a property that this packet cannot have"};
    }
    if (*id == kTopicAlias) {
      return Fault{EndReason::kTopicAlias, "a topic alias, though we announced none"};
    }
    if (judged && seen[*id] && *id != kUserProperty && *id != kSubscriptionId) {
      return Fault{EndReason::kMalformed, "a property stands twice"};
    }
    seen.set(*id);
    const auto value = ValueIn(known->kind, rest);
    if (!value || (judged && !IsValid(known->kind, *value))) {
      return Fault{EndReason::kMalformed, "a property without a valid value"};
    }
    Keep(known->id, *value, found);
  }
  return found;
}

}  // namespace uplink::mqtt
