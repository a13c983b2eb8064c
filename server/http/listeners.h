#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::http {

/// The listeners of HTTP that a server may have, each with its own key, limits and counts of
/// connections.
enum class ListenerId : std::uint8_t {
  /// Everything, on loopback.
  kHttp,
  /// Probes and scrapes alone, on any address.
  kMetrics,
};

/// By ListenerId.
inline constexpr std::array<std::string_view, 2> kListenerKeys = {"listen.http", "listen.metrics"};

/// The listener's place in lists of all.
[[nodiscard]] constexpr std::size_t PlaceOf(ListenerId listener) {
  return static_cast<std::size_t>(listener);
}
[[nodiscard]] constexpr std::string_view KeyOf(ListenerId listener) {
  return kListenerKeys[PlaceOf(listener)];
}

}  // namespace uplink::http
