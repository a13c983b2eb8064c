#pragma once

#include <cstdint>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::bench {

/// A port of the loopback that was free a moment ago.
[[nodiscard]] inline std::uint16_t FreePort() {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  UPLINK_CHECK(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                   getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) == 0,
               "there is a free port");
  close(descriptor);
  return ntohs(address.sin_port);
}

}  // namespace uplink::bench
