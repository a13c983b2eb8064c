#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::model {

/// Why a robot's connection ended. The numbers are what stores keep.
enum class ConnectionEnd : std::uint8_t {
  /// The robot, or its gateway, closed it as the protocol says.
  kOrderly = 0,
  /// The network or the robot's process cut it.
  kBroken = 1,
  /// Nothing answered any more, not even keepalive.
  kSilent = 2,
  /// A newer one of the same robot took its place, here or at another server.
  kReplaced = 3,
  /// The server drained, or the connection reached its age.
  kDrained = 4,
  /// The robot did not read what the server wrote.
  kNotRead = 5,
  kProtocolError = 6,
  /// The server refused to go on: a bound, a right, a forgotten robot.
  kRefused = 7,
  kCertificateExpired = 8,
  /// The server died, or failed.
  kServerEnded = 9,
};

/// Every reason, in number order.
inline constexpr std::array kAllConnectionEnds = {
    ConnectionEnd::kOrderly,       ConnectionEnd::kBroken,  ConnectionEnd::kSilent,
    ConnectionEnd::kReplaced,      ConnectionEnd::kDrained, ConnectionEnd::kNotRead,
    ConnectionEnd::kProtocolError, ConnectionEnd::kRefused, ConnectionEnd::kCertificateExpired,
    ConnectionEnd::kServerEnded,
};

/// `orderly`, `broken`, `silent`, `replaced`, `drained`, `not_read`, `protocol_error`, `refused`,
/// `certificate_expired` or `server_ended`.
[[nodiscard]] std::string_view ToText(ConnectionEnd end);
/// The reason that ToText spells so, or nothing.
[[nodiscard]] std::optional<ConnectionEnd> ConnectionEndFromText(std::string_view text);

}  // namespace uplink::model
