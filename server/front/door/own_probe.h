#pragma once

#include <cstdint>

#include <sys/socket.h>

namespace uplink::front {

/// Whether a connection that was accepted is the server's own handshake with its listener, which
/// comes from `port`: it comes from the very address at which it reached us, so from this machine,
/// and from that port, which one connection alone can have. Port 0: none is under way.
[[nodiscard]] bool IsOwnProbe(int descriptor, const sockaddr_storage& peer, std::uint16_t port);

}  // namespace uplink::front
