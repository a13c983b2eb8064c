#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::mqtt {

/// Why a connection to a broker, or the attempt to make one, ended. Metrics, logs and documents
/// share the names.
enum class EndReason : std::uint8_t {
  kStopped,           // we were told to stop
  kSettings,          // a file of ours cannot be used
  kResolve,           // the name has no address
  kConnect,           // no one accepted the connection
  kTls,               // the handshake failed
  kTimeout,           // no answer to a step of connecting or subscribing
  kRefused,           // CONNACK with a reason
  kClosed,            // the broker closed without a word
  kBroken,            // the connection broke
  kDisconnected,      // DISCONNECT with a reason (MQTT 5)
  kIdTaken,           // DISCONNECT: another client uses our id
  kPingLate,          // neither PINGRESP nor anything else came
  kWriteStalled,      // the broker does not take what we write
  kMalformed,         // bytes that MQTT does not have
  kTooLarge,          // an answer over our bound
  kUnknownProperty,   // a property that MQTT 5 does not have
  kTopicAlias,        // a topic alias, though we announced none
  kQos2,              // a PUBLISH at QoS 2, for which we never ask
  kUnexpectedPacket,  // a packet that no broker sends to a subscriber
  kUnexpectedAnswer,  // an answer to nothing that we asked
  kBehind,            // we ended it: its messages are too old by the time that we read them
};

/// In the order of EndReason.
inline constexpr std::array<std::string_view, 21> kEndReasonNames = {
    "stopped",       "settings",     "resolve",           "connect",
    "tls",           "timeout",      "refused",           "closed",
    "broken",        "disconnected", "id_taken",          "ping_late",
    "write_stalled", "malformed",    "too_large",         "unknown_property",
    "topic_alias",   "qos2",         "unexpected_packet", "unexpected_answer",
    "behind"};
static_assert(static_cast<std::size_t>(EndReason::kBehind) + 1 == kEndReasonNames.size());

[[nodiscard]] constexpr std::string_view Name(EndReason reason) {
  return kEndReasonNames[static_cast<std::size_t>(reason)];
}

/// The end of a connection. A value.
struct End {
  EndReason reason = EndReason::kStopped;
  /// For people; bounded by kErrorBytesMax where a peer had a say in it.
  std::string text;
};

/// What is wrong with bytes of a broker, without a copy of any. A value; `text` is a literal.
struct Fault {
  EndReason reason = EndReason::kMalformed;
  const char* text = "";
};

}  // namespace uplink::mqtt
