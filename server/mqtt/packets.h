#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/mqtt/end_reason.h"

namespace uplink::mqtt {

enum class Version : std::uint8_t { k311, k5 };

/// The upper half of a packet's first byte.
enum class PacketType : std::uint8_t {
  kConnect = 1,
  kConnack = 2,
  kPublish = 3,
  kPuback = 4,
  kSubscribe = 8,
  kSuback = 9,
  kUnsubscribe = 10,
  kUnsuback = 11,
  kPingreq = 12,
  kPingresp = 13,
  kDisconnect = 14,
};

/// Zero means none.
using PacketId = std::uint16_t;

enum class Qos : std::uint8_t { kAtMostOnce = 0, kAtLeastOnce = 1 };

/// A subscription. A value.
struct Filter {
  std::string topic;
  Qos qos = Qos::kAtMostOnce;

  friend bool operator==(const Filter&, const Filter&) = default;
};

// Packets that we send.

struct Connect {
  Version version = Version::k5;
  std::string client_id;
  /// False: resumes the broker's session of this id, or begins a kept one.
  bool clean = true;
  std::uint16_t keepalive_seconds = 60;
  std::optional<std::string> username;
  std::optional<std::string> password;
  // These three in MQTT 5 only; empty: not sent.
  std::optional<std::uint32_t> session_expiry_seconds;
  std::optional<std::uint16_t> receive_maximum;
  std::optional<std::uint32_t> packet_bytes_max;
};

/// A PUBLISH at QoS 0.
struct Outgoing {
  std::string topic;
  std::string payload;
  /// In MQTT 5 only; empty: none.
  std::string correlation;
};

// Packets that a broker sends. Views are into the bytes that were read.

struct Connack {
  bool session_present = false;
  /// 0: accepted. MQTT 5 and 3.1.1 number the others differently.
  std::uint8_t code = 0;
  // By MQTT 5 alone.
  std::optional<std::uint16_t> server_keepalive_seconds;
  /// Empty: as long as was asked for.
  std::optional<std::uint32_t> session_expiry_seconds;
  std::optional<std::uint32_t> packet_bytes_max;
  std::string_view reason;
};

struct Publish {
  /// Unchanged if `bad_topic`: do not show its bytes then.
  std::string_view topic;
  /// An invalid topic: empty, not UTF-8, or with NUL or a wildcard. Some brokers pass that on.
  bool bad_topic = false;
  Qos qos = Qos::kAtMostOnce;
  /// The broker says that it may have sent this before.
  bool dup = false;
  bool retained = false;
  /// 0 at QoS 0.
  PacketId id = 0;
  /// Empty if there was none, or more than kCorrelationBytesMax.
  std::string_view correlation;
  /// The publisher named a topic for answers. We note that and never use it.
  bool has_response_topic = false;
  /// Empty if it was over the bound and skipped, or `head_unread`.
  std::optional<std::string_view> payload;
  /// If `head_unread`, the bytes of everything after the packet's fixed header.
  std::size_t payload_bytes = 0;
  /// Its head was over kHeadBytesMax: everything after the topic and the id was skipped.
  bool head_unread = false;
};

struct Suback {
  PacketId id = 0;
  /// One byte for each filter, in their order: a QoS, or 128 and more for a refusal.
  std::string_view codes;
};

struct Unsuback {
  PacketId id = 0;
  /// Empty by 3.1.1.
  std::string_view codes;
};

struct Pingresp {};

struct Disconnect {
  std::uint8_t code = 0;
  std::string_view reason;
};

using Packet = std::variant<Connack, Publish, Suback, Unsuback, Pingresp, Disconnect>;

/// A part of a packet, or what is wrong with it.
template <typename T>
using Decoded = std::variant<T, Fault>;

}  // namespace uplink::mqtt
