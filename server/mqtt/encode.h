#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "server/mqtt/packets.h"

namespace uplink::mqtt {

// The bytes of what a subscriber says.
//
// Limits:  fields have at most kFieldBytesMax bytes and a packet at most kRemainingLengthMax:
// whoever
//          calls has checked (settings.h, Conversation); more is a mistake of ours and aborts.
// Thread:  pure; any thread.
// Source:  MQTT 3.1.1 and 5.0 (OASIS), chapter 3.

[[nodiscard]] std::string EncodeConnect(const Connect& connect);
/// At least one filter. By MQTT 5 we ask for no retained messages (retain handling 2).
[[nodiscard]] std::string EncodeSubscribe(Version version, PacketId id,
                                          std::span<const Filter> filters);
[[nodiscard]] std::string EncodeUnsubscribe(Version version, PacketId id,
                                            std::span<const std::string> topics);
/// Success in both versions.
[[nodiscard]] std::string EncodePuback(PacketId id);
[[nodiscard]] std::string EncodePublish(Version version, const Outgoing& message);
[[nodiscard]] std::string EncodePingreq();
/// `code`: why, by MQTT 5 alone; 0 is in order.
[[nodiscard]] std::string EncodeDisconnect(Version version, std::uint8_t code);

}  // namespace uplink::mqtt
