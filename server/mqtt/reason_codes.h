#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/mqtt/end_reason.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// MQTT 5's "Session taken over".
inline constexpr std::uint8_t kSessionTakenOver = 0x8E;

/// A reason for people: `not authorized (0x87)`, with the broker's own text, bounded and printable.
/// `text` may be empty.
[[nodiscard]] std::string ReasonText(std::uint8_t code, std::string_view text);
/// Whether a CONNACK of 3.1.1 refuses with this code; MQTT 5 has none of these.
[[nodiscard]] bool IsRefusalOf311(std::uint8_t code);
/// The same for a CONNACK, which has its own codes in 3.1.1. A broker with only 3.1.1 answers MQTT
/// 5 with them too; the text then says what to set.
[[nodiscard]] std::string ConnackText(Version version, std::uint8_t code, std::string_view text);

/// The code of our MQTT 5 DISCONNECT when a connection ended for this reason.
[[nodiscard]] std::uint8_t FarewellCode(EndReason reason);

// Thread:  pure; any thread.
// Source:  MQTT 5.0, table 2-6; MQTT 3.1.1, table 3.1.

}  // namespace uplink::mqtt
