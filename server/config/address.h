#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::config {

/// Where a listener binds: a literal IP address (never a name, so that start-up asks no resolver)
/// and a port; port 0 takes any free one and the log names it. A value.
struct ListenAddress {
  /// Without brackets: `::`, `127.0.0.1`.
  std::string host;
  std::uint16_t port = 0;

  friend bool operator==(const ListenAddress&, const ListenAddress&) = default;
};

/// Reads `127.0.0.1:7480` or `[::]:7443`; nothing if the text is neither.
[[nodiscard]] std::optional<ListenAddress> ParseListenAddress(std::string_view text);

/// The text that ParseListenAddress reads back.
[[nodiscard]] std::string ToText(const ListenAddress& address);

/// True if only this machine can reach the address (127.0.0.0/8 or ::1).
[[nodiscard]] bool IsLoopback(const ListenAddress& address);
/// The same of an address without port and brackets, or of the name `localhost`.
[[nodiscard]] bool IsLoopbackHost(const std::string& host);

}  // namespace uplink::config
