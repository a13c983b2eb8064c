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
  /// The RURI that its certificate names, once it has shown a trusted one, for logs: it may have
  /// expired.
  std::string robot = {};
  /// The subject of a gateway's certificate, the same; then `robot` is whom a stream spoke for.
  std::string gateway = {};
  /// The subject of one that names neither a robot nor a gateway, the same.
  std::string subject = {};
  /// A load balancer came on its own account, to see whether we answer: unless it shows a
  /// certificate, what becomes of it is neither counted nor logged.
  bool health_check = false;
  /// The server asks itself whether it still answers; a health check, too.
  bool own = false;
  /// A robot streams from its source, or did lately (KnownSources).
  bool known = false;

  /// A trusted certificate was shown: whoever has one does more than look.
  void NotePeer(const std::string& of_robot, const std::string& of_gateway,
                const std::string& of_nobody) {
    robot = of_robot;
    gateway = of_gateway;
    subject = of_nobody;
    health_check = false;
  }
};

[[nodiscard]] Origin OriginOf(const sockaddr_storage& peer);

/// Whether a connection that was accepted is the server's own handshake with its listener, which
/// comes from `port`: it comes from the very address at which it reached us, so from this machine,
/// and from that port, which one connection alone can have. Port 0: none is under way.
[[nodiscard]] bool IsOwnProbe(int descriptor, const sockaddr_storage& peer, std::uint16_t port);

}  // namespace uplink::front
