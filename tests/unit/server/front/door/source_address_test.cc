#include "server/front/door/source_address.h"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>

namespace uplink::front {
namespace {

static_assert(std::regular<SourceAddress>);

in_addr Ipv4(const char* text) {
  in_addr address{};
  EXPECT_EQ(inet_pton(AF_INET, text, &address), 1) << text;
  return address;
}

in6_addr Ipv6(const char* text) {
  in6_addr address{};
  EXPECT_EQ(inet_pton(AF_INET6, text, &address), 1) << text;
  return address;
}

template <typename Address>
sockaddr_storage Peer(const Address& address) {
  sockaddr_storage peer{};
  std::memcpy(&peer, &address, sizeof(address));
  return peer;
}

TEST(SourceAddress, IsUnknownAtFirst) { EXPECT_EQ(SourceAddress().ToText(), "unknown"); }

TEST(SourceAddress, IsAnIpv4AddressWhateverThePort) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = Ipv4("192.0.2.1");
  address.sin_port = htons(4711);
  const SourceAddress source = SourceAddress::Of(Peer(address));
  EXPECT_EQ(source, SourceAddress::Of(Ipv4("192.0.2.1")));
  EXPECT_EQ(source.ToText(), "192.0.2.1");
}

TEST(SourceAddress, TellsNeighboursInIpv4Apart) {
  EXPECT_NE(SourceAddress::Of(Ipv4("192.0.2.1")), SourceAddress::Of(Ipv4("192.0.2.2")));
}

TEST(SourceAddress, Ipv4InIpv6IsTheIpv4Address) {
  EXPECT_EQ(SourceAddress::Of(Ipv6("::ffff:192.0.2.1")), SourceAddress::Of(Ipv4("192.0.2.1")));
  EXPECT_NE(SourceAddress::Of(Ipv6("::ffff:192.0.2.1")), SourceAddress::Of(Ipv4("192.0.2.2")));
}

TEST(SourceAddress, IsThe64OfAnIpv6Address) {
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_addr = Ipv6("2001:db8:1:2:3:4:5:6");
  address.sin6_port = htons(4711);
  address.sin6_scope_id = 3;
  const SourceAddress source = SourceAddress::Of(Peer(address));
  EXPECT_EQ(source, SourceAddress::Of(Ipv6("2001:db8:1:2:ffff:ffff:ffff:ffff")));
  EXPECT_NE(source, SourceAddress::Of(Ipv6("2001:db8:1:3:3:4:5:6")));
  EXPECT_EQ(source.ToText(), "2001:db8:1:2::/64");
}

TEST(SourceAddress, ShortensZerosInIpv6) {
  EXPECT_EQ(SourceAddress::Of(Ipv6("2001:db8::1")).ToText(), "2001:db8::/64");
  EXPECT_EQ(SourceAddress::Of(Ipv6("2001:0:0:1::1")).ToText(), "2001:0:0:1::/64");
}

TEST(SourceAddress, TheFirst64IsNotUnknown) {
  const SourceAddress loopback = SourceAddress::Of(Ipv6("::1"));
  EXPECT_NE(loopback, SourceAddress());
  EXPECT_EQ(loopback.ToText(), "::/64");
  EXPECT_NE(SourceAddress::Of(Ipv4("0.0.0.0")), SourceAddress());
}

TEST(SourceAddress, IsUnknownOfAnotherFamily) {
  sockaddr_storage peer{};
  std::memset(&peer, 0x5A, sizeof(peer));
  peer.ss_family = AF_UNIX;
  EXPECT_EQ(SourceAddress::Of(peer), SourceAddress());
}

}  // namespace
}  // namespace uplink::front
