#include "server/front/door/source_address.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include <arpa/inet.h>
#include <fmt/format.h>

namespace uplink::front {
namespace {

constexpr std::array<std::uint8_t, 12> kIpv4InIpv6{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
constexpr std::size_t kIpv6PrefixBytes = 8;
constexpr std::uint8_t kIpv6PrefixBits = 64;

template <typename Address>
Address Read(const sockaddr_storage& peer) {
  static_assert(sizeof(Address) <= sizeof(peer));
  Address address;
  std::memcpy(&address, &peer, sizeof(address));
  return address;
}

}  // namespace

SourceAddress SourceAddress::Of(const sockaddr_storage& peer) {
  if (peer.ss_family == AF_INET) return Of(Read<sockaddr_in>(peer).sin_addr);
  if (peer.ss_family == AF_INET6) return Of(Read<sockaddr_in6>(peer).sin6_addr);
  return {};
}

SourceAddress SourceAddress::Of(const in_addr& address) {
  SourceAddress source;
  std::copy(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), source.bytes_.begin());
  std::memcpy(&source.bytes_[kIpv4InIpv6.size()], &address, sizeof(address));
  return source;
}

SourceAddress SourceAddress::Of(const in6_addr& address) {
  SourceAddress source;
  static_assert(sizeof(address) == sizeof(source.bytes_));
  std::memcpy(source.bytes_.data(), &address, sizeof(address));
  if (std::equal(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), source.bytes_.begin())) return source;
  std::fill(source.bytes_.begin() + kIpv6PrefixBytes, source.bytes_.end(), std::uint8_t{0});
  source.bytes_.back() = kIpv6PrefixBits;
  return source;
}

std::string SourceAddress::ToText() const {
  if (*this == SourceAddress()) return "unknown";
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (std::equal(kIpv4InIpv6.begin(), kIpv4InIpv6.end(), bytes_.begin())) {
    inet_ntop(AF_INET, &bytes_[kIpv4InIpv6.size()], text.data(), text.size());
    return text.data();
  }
  std::array<std::uint8_t, 16> prefix{};
  std::copy_n(bytes_.begin(), kIpv6PrefixBytes, prefix.begin());
  inet_ntop(AF_INET6, prefix.data(), text.data(), text.size());
  return fmt::format("{}/{}", text.data(), kIpv6PrefixBits);
}

}  // namespace uplink::front
