#include "server/front/door/origin.h"

#include <array>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>

namespace uplink::front {
namespace {

/// The peer's address and port, as gRPC names peers.
std::string TextOf(const sockaddr_storage& peer) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  if (::getnameinfo(reinterpret_cast<const sockaddr*>(&peer), sizeof(peer), host.data(),
                    host.size(), port.data(), port.size(), NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return "unknown";
  }
  constexpr std::string_view kMapped = "::ffff:";
  std::string_view text = host.data();
  if (peer.ss_family != AF_INET6) return fmt::format("{}:{}", text, port.data());
  if (text.starts_with(kMapped)) {
    return fmt::format("{}:{}", text.substr(kMapped.size()), port.data());
  }
  return fmt::format("[{}]:{}", text, port.data());
}

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

Origin OriginOf(const sockaddr_storage& peer) {
  return {.source = SourceAddress::Of(peer), .text = TextOf(peer)};
}

bool IsOwnProbe(int descriptor, const sockaddr_storage& peer, std::uint16_t port) {
  // Both families keep the port at the same place.
  if (port == 0 || ntohs(reinterpret_cast<const sockaddr_in&>(peer).sin_port) != port) return false;
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  return ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
         IsSameAddress(peer, own);
}

}  // namespace uplink::front
