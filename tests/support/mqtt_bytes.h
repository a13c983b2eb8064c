#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::testing {

// Bytes of MQTT as a broker writes them, by hand, so that what reads them is not tested by what
// writes them.

[[nodiscard]] inline std::string MqttU16(std::size_t number) {
  return {static_cast<char>(number >> 8U), static_cast<char>(number & 0xFFU)};
}

[[nodiscard]] inline std::string MqttLength(std::size_t length) {
  std::string digits;
  do {
    const std::size_t digit = length % 128;
    length /= 128;
    digits.push_back(static_cast<char>(length > 0 ? digit + 128 : digit));
  } while (length > 0);
  return digits;
}

[[nodiscard]] inline std::string MqttField(std::string_view field) {
  return MqttU16(field.size()).append(field);
}

/// A packet by its first byte.
[[nodiscard]] inline std::string MqttPacket(unsigned first, std::string_view body) {
  return std::string(1, static_cast<char>(first)).append(MqttLength(body.size())).append(body);
}

/// The properties of a packet of MQTT 5, their length before them.
[[nodiscard]] inline std::string MqttProperties(std::string_view properties) {
  return MqttLength(properties.size()).append(properties);
}

/// Bytes of a literal that may hold NUL.
template <std::size_t kSize>
[[nodiscard]] std::string Raw(const char (&text)[kSize]) {
  return {text, kSize - 1};
}

/// What a PUBLISH says; a value.
struct PublishBytes {
  std::string topic = "t";
  std::string payload;
  /// 0: QoS 0.
  std::size_t id = 0;
  bool dup = false;
  bool retained = false;
  /// By MQTT 5: its properties; by 3.1.1 it has none.
  bool mqtt5 = true;
  std::string properties;

  [[nodiscard]] std::string Text() const {
    const unsigned first = 0x30U | (dup ? 8U : 0U) | (id > 0 ? 2U : 0U) | (retained ? 1U : 0U);
    std::string body = MqttField(topic);
    if (id > 0) body += MqttU16(id);
    if (mqtt5) body += MqttProperties(properties);
    return MqttPacket(first, body + payload);
  }
};

}  // namespace uplink::testing
