#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/socket.h>

#include "server/config/networks.h"
#include "server/http/places.h"
#include "server/http/source.h"

namespace uplink::http {

/// Who is at the other end of a connection. A value.
struct Peer {
  Source source{};
  /// Its address, without a port, or `unix`; for the log.
  std::string text = "unknown";
  /// It came by a Unix socket.
  bool on_machine = false;
  /// It may speak HTTP without TLS.
  bool plain = true;
  /// It may say by X-Forwarded-For whom it speaks for, where it speaks without TLS.
  bool proxy = false;

  [[nodiscard]] Places::Of of() const { return proxy ? Places::Of::kProxy : Places::Of::kSource; }
};

/// Of another family than IPv4 and IPv6: one on a Unix socket, that the socket's mode lets in.
[[nodiscard]] Peer PeerOf(const sockaddr_storage& address,
                          const std::vector<config::Network>& plain_from);

/// The rightmost address of an X-Forwarded-For header, which the nearest proxy has added, with or
/// without a port; nothing if there is none.
[[nodiscard]] std::optional<Peer> ForwardedFor(std::string_view header);

}  // namespace uplink::http
