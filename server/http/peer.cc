#include "server/http/peer.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace uplink::http {
namespace {

/// As IPv6, or as IPv4 in IPv6.
using Bytes = std::array<std::uint8_t, 16>;

Bytes BytesOf(const in_addr& address) {
  Bytes bytes{};
  bytes[10] = bytes[11] = 0xFF;
  std::memcpy(&bytes[12], &address, sizeof(address));
  return bytes;
}

Bytes BytesOf(const in6_addr& address) {
  Bytes bytes{};
  static_assert(sizeof(address) == sizeof(bytes));
  std::memcpy(bytes.data(), &address, sizeof(address));
  return bytes;
}

template <typename Address>
Peer Of(int family, const Address& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  inet_ntop(family, &address, text.data(), text.size());
  return {.source = SourceOf(BytesOf(address)), .text = text.data(), .plain = false};
}

/// An IPv4 address in IPv6 is shown as what it is.
Peer OfIpv6(const in6_addr& address) {
  if (!IN6_IS_ADDR_V4MAPPED(&address)) return Of(AF_INET6, address);
  in_addr v4{};
  std::memcpy(&v4, &address.s6_addr[12], sizeof(v4));
  return Of(AF_INET, v4);
}

template <typename Address>
Address Read(const sockaddr_storage& peer) {
  static_assert(sizeof(Address) <= sizeof(peer));
  Address address;
  std::memcpy(&address, &peer, sizeof(address));
  return address;
}

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// `[2001:db8::7]:4711`, `192.0.2.7:4711` and each without a port, as proxies write them.
std::string_view WithoutPort(std::string_view text) {
  if (text.starts_with('[')) return text.substr(1, text.find(']') - 1);
  const bool one_colon = std::ranges::count(text, ':') == 1;
  return one_colon ? text.substr(0, text.find(':')) : text;
}

}  // namespace

Peer PeerOf(const sockaddr_storage& address, const std::vector<config::Network>& plain_from) {
  Peer peer;
  if (address.ss_family == AF_INET) {
    peer = Of(AF_INET, Read<sockaddr_in>(address).sin_addr);
  } else if (address.ss_family == AF_INET6) {
    peer = OfIpv6(Read<sockaddr_in6>(address).sin6_addr);
  } else {
    return {.source = {}, .text = "unix", .on_machine = true, .proxy = true};
  }
  peer.plain = peer.proxy = config::Contains(plain_from, address);
  return peer;
}

std::optional<Peer> ForwardedFor(std::string_view header) {
  const std::size_t comma = header.rfind(',');
  if (comma != std::string_view::npos) header.remove_prefix(comma + 1);
  const std::string text(WithoutPort(Trim(header)));
  in_addr v4{};
  if (inet_pton(AF_INET, text.c_str(), &v4) == 1) return Of(AF_INET, v4);
  in6_addr v6{};
  if (inet_pton(AF_INET6, text.c_str(), &v6) == 1) return OfIpv6(v6);
  return std::nullopt;
}

}  // namespace uplink::http
