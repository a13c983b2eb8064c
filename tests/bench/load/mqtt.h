#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// As much of MQTT 3.1.1 as the benchmarks speak.
namespace uplink::bench {

inline constexpr char kMqttConnect = 0x10;
inline constexpr char kMqttConnack = 0x20;
/// Its low bits are flags; the packets' names here are those of QoS 0 and 1.
inline constexpr char kMqttPublish = 0x30;
inline constexpr char kMqttPublishQos1 = 0x32;
inline constexpr char kMqttPuback = 0x40;
inline constexpr auto kMqttSubscribe = static_cast<char>(0x82);
inline constexpr auto kMqttSuback = static_cast<char>(0x90);

/// Two bytes of length, and the text.
void AppendMqttText(std::string& to, std::string_view text);
void AppendMqttNumber(std::string& to, std::uint16_t number);
/// A packet's length: seven bits a byte, the lowest first.
void AppendMqttLength(std::string& to, std::size_t length);
/// CONNECT of this client: a clean session without keepalive.
[[nodiscard]] std::string MqttConnectPacket(std::string_view client);
/// SUBSCRIBE to one topic.
[[nodiscard]] std::string MqttSubscribePacket(std::string_view topic, std::uint8_t qos);

/// What stands at the front of received bytes. A value; views refer to those bytes.
struct MqttPacket {
  enum class State : std::uint8_t { kWhole, kPartial, kMalformed };
  State state = State::kPartial;
  /// Type and flags.
  char head = 0;
  std::string_view body;
  /// What the whole packet takes.
  std::size_t bytes = 0;
};
[[nodiscard]] MqttPacket ReadMqttPacket(std::string_view in);

/// A PUBLISH. A value; views refer to its packet.
struct MqttMessage {
  std::string_view topic;
  /// By which it is acknowledged; nothing at QoS 0.
  std::optional<std::uint16_t> packet;
  std::string_view payload;
};
/// Nothing: the packet is no PUBLISH of QoS 0 or 1, or its lengths do not fit.
[[nodiscard]] std::optional<MqttMessage> ReadMqttPublish(const MqttPacket& packet);

}  // namespace uplink::bench
