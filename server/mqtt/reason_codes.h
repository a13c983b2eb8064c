#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/mqtt/end_reason.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// MQTT 5's "Session taken over".
inline constexpr std::uint8_t kSessionTakenOver = 0x8E;

/// A reason for people: `not authorized (0x87)`, with what the broker said about it, bounded and
/// printable. `text` may be empty.
[[nodiscard]] std::string ReasonText(std::uint8_t code, std::string_view text);
/// A code by which a CONNACK of 3.1.1 refuses. MQTT 5 has none of them.
[[nodiscard]] bool IsRefusalOf311(std::uint8_t code);
/// The same for a CONNACK, whose codes 3.1.1 numbers by itself: a broker that has 3.1.1 alone
/// answers MQTT 5 by them, too, and then the text says what to set.
[[nodiscard]] std::string ConnackText(Version version, std::uint8_t code, std::string_view text);

/// What our DISCONNECT says by MQTT 5 when a connection ended for this reason.
[[nodiscard]] std::uint8_t FarewellCode(EndReason reason);

// Thread:  pure; any thread.
// Source:  MQTT 5.0, table 2-6; MQTT 3.1.1, table 3.1.

}  // namespace uplink::mqtt
