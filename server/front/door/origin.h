#pragma once

#include <cstdint>
#include <string>

#include <sys/socket.h>

#include "server/front/door/source_address.h"

namespace uplink::front {

/// Where a connection comes from. A value.
struct Origin {
  SourceAddress source;
  /// Address and port, for logs.
  std::string text;
  /// For logs: the RURI in its certificate, once it has shown a trusted one, which may have
  /// expired.
  std::string robot = {};
  /// The same for a gateway: its certificate's subject; then `robot` is the robot that a stream
  /// spoke for.
  std::string gateway = {};
  /// The same for a certificate that names neither a robot nor a gateway: its subject.
  std::string subject = {};
  /// A load balancer checks whether we answer. Unless it shows a certificate, the connection is
  /// neither counted nor logged.
  bool health_check = false;
  /// The server checks itself; also a health check.
  bool own = false;
  /// A robot streams from its source, or did lately (KnownSources).
  bool known = false;

  /// A trusted certificate was shown, so this is no health check.
  void NotePeer(const std::string& of_robot, const std::string& of_gateway,
                const std::string& of_other) {
    robot = of_robot;
    gateway = of_gateway;
    subject = of_other;
    health_check = false;
  }
};

[[nodiscard]] Origin OriginOf(const sockaddr_storage& peer);

/// Whether an accepted connection is the server's own handshake with its listener from `port`. It
/// comes from the address at which it reached us, so from this machine, and from that port, which
/// only one connection can have. Port 0: none is under way.
[[nodiscard]] bool IsOwnProbe(int descriptor, const sockaddr_storage& peer, std::uint16_t port);

}  // namespace uplink::front
