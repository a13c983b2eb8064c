#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>

namespace uplink::bench {

/// Bytes of Hello.session_id (relay.proto).
inline constexpr std::size_t kSessionIdBytes = 16;

/// Random bytes for a new numbering.
[[nodiscard]] inline std::string NewSessionId() {
  std::random_device random;
  std::string session(kSessionIdBytes, '\0');
  std::ranges::generate(session, [&] { return static_cast<char>(random()); });
  return session;
}

}  // namespace uplink::bench
