#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::config {

/// Bytes of a socket's path: sockaddr_un has 108 with the NUL (unix(7)).
inline constexpr std::size_t kSocketPathBytesMax = 107;

/// Where a listener binds: a literal IP address (never a name, so that start-up asks no resolver)
/// and a port; port 0 takes any free one and the log names it. Or the path of a Unix socket. A
/// value.
struct ListenAddress {
  /// Without brackets: `::`, `127.0.0.1`. Empty: it is a path, or there is no listener.
  std::string host;
  std::uint16_t port = 0;
  /// Absolute; empty: it is a host, or there is no listener.
  std::string path{};

  friend bool operator==(const ListenAddress&, const ListenAddress&) = default;
};

/// Reads `127.0.0.1:7480`, `[::]:7443` or `unix:/run/uplinkd/http.sock`; nothing if the text is
/// none of them.
[[nodiscard]] std::optional<ListenAddress> ParseListenAddress(std::string_view text);

/// The text that ParseListenAddress reads back; empty if there is no listener.
[[nodiscard]] std::string ToText(const ListenAddress& address);

/// Whether there is such a listener.
[[nodiscard]] bool IsSet(const ListenAddress& address);

/// Whether it is a Unix socket.
[[nodiscard]] bool IsUnix(const ListenAddress& address);

/// True if one socket cannot listen on `a` while another listens on `b`: the port is the same, and
/// the hosts are, or one stands for all (`::` for those of IPv4 too). Never with port 0. Paths
/// collide if they are written alike.
[[nodiscard]] bool Collide(const ListenAddress& a, const ListenAddress& b);

/// True if only this machine can reach the address (127.0.0.0/8, ::1 or a Unix socket).
[[nodiscard]] bool IsLoopback(const ListenAddress& address);
/// The same of an address without port and brackets, or of the name `localhost`.
[[nodiscard]] bool IsLoopbackHost(const std::string& host);

}  // namespace uplink::config
