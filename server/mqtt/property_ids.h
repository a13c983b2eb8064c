#pragma once

#include <cstdint>

namespace uplink::mqtt {

// Identifiers of MQTT 5's properties (OASIS, table 2-4), those that a broker may send or we do.
inline constexpr std::uint8_t kPayloadFormat = 0x01;
inline constexpr std::uint8_t kMessageExpiry = 0x02;
inline constexpr std::uint8_t kContentType = 0x03;
inline constexpr std::uint8_t kResponseTopic = 0x08;
inline constexpr std::uint8_t kCorrelationData = 0x09;
inline constexpr std::uint8_t kSubscriptionId = 0x0B;
inline constexpr std::uint8_t kSessionExpiry = 0x11;
inline constexpr std::uint8_t kAssignedClientId = 0x12;
inline constexpr std::uint8_t kServerKeepalive = 0x13;
inline constexpr std::uint8_t kAuthMethod = 0x15;
inline constexpr std::uint8_t kAuthData = 0x16;
inline constexpr std::uint8_t kResponseInformation = 0x1A;
inline constexpr std::uint8_t kServerReference = 0x1C;
inline constexpr std::uint8_t kReasonString = 0x1F;
inline constexpr std::uint8_t kReceiveMaximum = 0x21;
inline constexpr std::uint8_t kTopicAliasMaximum = 0x22;
inline constexpr std::uint8_t kTopicAlias = 0x23;
inline constexpr std::uint8_t kMaximumQos = 0x24;
inline constexpr std::uint8_t kRetainAvailable = 0x25;
inline constexpr std::uint8_t kUserProperty = 0x26;
inline constexpr std::uint8_t kMaximumPacketSize = 0x27;
inline constexpr std::uint8_t kWildcardAvailable = 0x28;
inline constexpr std::uint8_t kSubscriptionIdAvailable = 0x29;
inline constexpr std::uint8_t kSharedAvailable = 0x2A;

}  // namespace uplink::mqtt
