#include "server/http/peer.h"

#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/un.h>

namespace uplink::http {
namespace {

sockaddr_storage AddressOf(const char* text) {
  sockaddr_storage address{};
  auto* const v4 = reinterpret_cast<sockaddr_in*>(&address);
  auto* const v6 = reinterpret_cast<sockaddr_in6*>(&address);
  if (inet_pton(AF_INET, text, &v4->sin_addr) == 1) {
    v4->sin_family = AF_INET;
  } else if (inet_pton(AF_INET6, text, &v6->sin6_addr) == 1) {
    v6->sin6_family = AF_INET6;
  }
  return address;
}

Peer Of(const char* text) { return PeerOf(AddressOf(text), config::LoopbackNetworks()); }

TEST(PeerOf, MaySpeakPlainWhereItsNetworkIsNamed) {
  for (const char* text : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(Of(text).plain && Of(text).proxy) << text;
  }
  for (const char* text : {"192.0.2.7", "2001:db8::1", "::ffff:192.0.2.7"}) {
    EXPECT_FALSE(Of(text).plain || Of(text).proxy) << text;
  }
  EXPECT_EQ(Of("192.0.2.7").text, "192.0.2.7");
  EXPECT_EQ(Of("2001:db8::1").text, "2001:db8::1");
  EXPECT_EQ(Of("::ffff:192.0.2.7").text, "192.0.2.7");
}

TEST(PeerOf, ASourceIsAnIpv4AddressOrASlash64) {
  EXPECT_EQ(Of("192.0.2.7").source, Of("::ffff:192.0.2.7").source);
  EXPECT_NE(Of("192.0.2.7").source, Of("192.0.2.8").source);
  EXPECT_EQ(Of("2001:db8::1").source, Of("2001:db8::ffff:1").source);
  EXPECT_NE(Of("2001:db8::1").source, Of("2001:db8:0:1::1").source);
}

TEST(PeerOf, ASocketIsOnTheMachine) {
  sockaddr_storage address{};
  address.ss_family = AF_UNIX;
  const Peer peer = PeerOf(address, {});
  EXPECT_TRUE(peer.on_machine && peer.plain && peer.proxy);
  EXPECT_EQ(peer.text, "unix");
}

TEST(ForwardedFor, IsTheRightmostAddress) {
  for (const char* header :
       {"192.0.2.7", "198.51.100.1, 192.0.2.7", "evil,192.0.2.7 ", "x, 192.0.2.7:4711"}) {
    const auto peer = ForwardedFor(header);
    ASSERT_TRUE(peer) << header;
    EXPECT_EQ(peer->text, "192.0.2.7");
    EXPECT_EQ(peer->source, Of("192.0.2.7").source);
    EXPECT_FALSE(peer->plain || peer->proxy);
  }
  for (const char* header : {"2001:db8::7", "[2001:db8::7]", "a, [2001:db8::7]:4711"}) {
    ASSERT_TRUE(ForwardedFor(header)) << header;
    EXPECT_EQ(ForwardedFor(header)->text, "2001:db8::7");
  }
}

TEST(ForwardedFor, IsNothingWhereTheLastIsNoAddress) {
  for (const char* header :
       {"", "unknown", "192.0.2.7,", "192.0.2.7, unknown", "[", "[]", ":", "1.2.3"}) {
    EXPECT_FALSE(ForwardedFor(header)) << header;
  }
}

}  // namespace
}  // namespace uplink::http
