#include "server/front/door/own_probe.h"

#include <cstring>

#include <netinet/in.h>

namespace uplink::front {
namespace {

bool IsSameAddress(const sockaddr_storage& left, const sockaddr_storage& right) {
  if (left.ss_family != right.ss_family) return false;
  if (left.ss_family == AF_INET) {
    return reinterpret_cast<const sockaddr_in&>(left).sin_addr.s_addr ==
           reinterpret_cast<const sockaddr_in&>(right).sin_addr.s_addr;
  }
  return left.ss_family == AF_INET6 &&
         std::memcmp(&reinterpret_cast<const sockaddr_in6&>(left).sin6_addr,
                     &reinterpret_cast<const sockaddr_in6&>(right).sin6_addr,
                     sizeof(in6_addr)) == 0;
}

}  // namespace

bool IsOwnProbe(int descriptor, const sockaddr_storage& peer, std::uint16_t port) {
  // Both families keep the port at the same place.
  if (port == 0 || ntohs(reinterpret_cast<const sockaddr_in&>(peer).sin_port) != port) return false;
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  return ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
         IsSameAddress(peer, own);
}

}  // namespace uplink::front
