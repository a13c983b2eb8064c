#include "server/front/door/origin.h"

#include <array>
#include <string_view>

#include <fmt/format.h>
#include <netdb.h>

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

}  // namespace

Origin OriginOf(const sockaddr_storage& peer) {
  return {.source = SourceAddress::Of(peer), .text = TextOf(peer)};
}

}  // namespace uplink::front
