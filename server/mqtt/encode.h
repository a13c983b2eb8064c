#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "server/mqtt/packets.h"

namespace uplink::mqtt {

// Encodes the packets of a subscriber.
//
// Limits:  fields of at most kFieldBytesMax bytes, a packet of at most kRemainingLengthMax. Callers
//          check that (settings.h, Conversation); more is our bug and aborts.
// Thread:  pure; any thread.
// Source:  MQTT 3.1.1 and 5.0 (OASIS), chapter 3.

[[nodiscard]] std::string EncodeConnect(const Connect& connect);
/// At least one filter. In MQTT 5 we ask for no retained messages (retain handling 2).
[[nodiscard]] std::string EncodeSubscribe(Version version, PacketId id,
                                          std::span<const Filter> filters);
[[nodiscard]] std::string EncodeUnsubscribe(Version version, PacketId id,
                                            std::span<const std::string> topics);
/// Encodes success in both versions.
[[nodiscard]] std::string EncodePuback(PacketId id);
[[nodiscard]] std::string EncodePublish(Version version, const Outgoing& message);
[[nodiscard]] std::string EncodePingreq();
/// `code`: the reason, only in MQTT 5; 0 means normal.
[[nodiscard]] std::string EncodeDisconnect(Version version, std::uint8_t code);

}  // namespace uplink::mqtt
