#pragma once

#include <cstdint>

namespace uplink::bench {

// What the length-prefixed sink and its clients speak, in the machine's byte order.

/// Stands before the payloads of a frame.
struct SinkFrame {
  std::uint32_t bytes = 0;
  std::uint32_t messages = 0;
};

/// Sent after each kMessagesAnAck messages.
struct SinkAck {
  std::uint64_t messages = 0;
};

/// As the relay acks live messages (`limits` of the protocol page).
inline constexpr std::uint64_t kMessagesAnAck = 64;

}  // namespace uplink::bench
