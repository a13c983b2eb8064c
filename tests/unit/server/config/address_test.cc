#include "server/config/address.h"

#include <gtest/gtest.h>

namespace uplink::config {
namespace {

TEST(ParseListenAddressTest, ReadsBothFamilies) {
  EXPECT_EQ(ParseListenAddress("127.0.0.1:7480"), (ListenAddress{"127.0.0.1", 7480}));
  EXPECT_EQ(ParseListenAddress("[::]:7443"), (ListenAddress{"::", 7443}));
  EXPECT_EQ(ParseListenAddress("[fe80::1]:1"), (ListenAddress{"fe80::1", 1}));
}

TEST(ParseListenAddressTest, ReadsPortsFromZeroToTheLast) {
  EXPECT_EQ(ParseListenAddress("0.0.0.0:0"), (ListenAddress{"0.0.0.0", 0}));
  EXPECT_EQ(ParseListenAddress("0.0.0.0:65535"), (ListenAddress{"0.0.0.0", 65535}));
  EXPECT_EQ(ParseListenAddress("0.0.0.0:65536"), std::nullopt);
}

TEST(ParseListenAddressTest, RefusesWhatIsNoLiteralAddressWithAPort) {
  for (const char* const text :
       {"", ":", ":7443", "127.0.0.1", "127.0.0.1:", "localhost:7443", "::1:7443", "[127.0.0.1]:1",
        "[::]", "[]:1", "127.0.0.1:-1", "127.0.0.1: 1", "127.0.0.256:1", "*:7443"}) {
    EXPECT_EQ(ParseListenAddress(text), std::nullopt) << text;
  }
}

TEST(ParseListenAddressTest, RefusesAnEmbeddedNul) {
  EXPECT_EQ(ParseListenAddress(std::string_view("127.0.0.1\0x:1", 13)), std::nullopt);
}

TEST(ListenAddressTextTest, ReadsBackToTheSameAddress) {
  for (const char* const text : {"[::]:7443", "127.0.0.1:0", "[::1]:7480"}) {
    EXPECT_EQ(ToText(ParseListenAddress(text).value()), text);
  }
}

TEST(ParseListenAddressTest, ReadsThePathOfASocket) {
  const auto address = ParseListenAddress("unix:/run/uplinkd/http.sock");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->path, "/run/uplinkd/http.sock");
  EXPECT_TRUE(IsUnix(*address) && IsSet(*address) && IsLoopback(*address));
  EXPECT_EQ(ToText(*address), "unix:/run/uplinkd/http.sock");
  EXPECT_FALSE(IsUnix({"::1", 1}));
}

TEST(ParseListenAddressTest, RefusesAPathThatNoSocketCanHave) {
  const std::string longest = "/" + std::string(kSocketPathBytesMax - 1, 'a');
  EXPECT_TRUE(ParseListenAddress("unix:" + longest));
  for (const std::string& path :
       {std::string(), std::string("/"), std::string("run/x.sock"), std::string("/run/"),
        longest + "a", std::string("/a\nb"), std::string("/a\0b", 4), std::string("/a\xff")}) {
    EXPECT_EQ(ParseListenAddress("unix:" + path), std::nullopt) << path;
  }
}

TEST(ListenAddressTextTest, OfNoListenerIsEmpty) { EXPECT_EQ(ToText(ListenAddress()), ""); }

TEST(IsSetTest, AHostMakesAListenerAlsoOnAnyPort) {
  EXPECT_TRUE(IsSet({"127.0.0.1", 0}));
  EXPECT_FALSE(IsSet(ListenAddress()));
}

TEST(CollideTest, OnePortOfOneHostIsTakenOnce) {
  const auto collide = [](std::string_view a, std::string_view b) {
    const ListenAddress first = ParseListenAddress(a).value();
    const ListenAddress second = ParseListenAddress(b).value();
    EXPECT_EQ(Collide(first, second), Collide(second, first)) << a << " and " << b;
    return Collide(first, second);
  };
  EXPECT_TRUE(collide("192.0.2.7:9090", "192.0.2.7:9090"));
  EXPECT_TRUE(collide("[2001:db8::7]:9090", "[2001:db8:0::7]:9090")) << "written otherwise";
  EXPECT_TRUE(collide("[::ffff:192.0.2.7]:9090", "192.0.2.7:9090"));
  EXPECT_TRUE(collide("0.0.0.0:9090", "192.0.2.7:9090"));
  EXPECT_TRUE(collide("[::]:9090", "192.0.2.7:9090"));
  EXPECT_TRUE(collide("[::]:9090", "0.0.0.0:9090"));
  EXPECT_TRUE(collide("[::]:9090", "[2001:db8::7]:9090"));

  EXPECT_FALSE(collide("192.0.2.7:9090", "192.0.2.7:9091"));
  EXPECT_FALSE(collide("192.0.2.7:9090", "192.0.2.8:9090"));
  EXPECT_FALSE(collide("0.0.0.0:9090", "[2001:db8::7]:9090"));
  EXPECT_FALSE(collide("[::]:0", "[::]:0")) << "each takes a free one";
  EXPECT_FALSE(Collide(ListenAddress(), ListenAddress())) << "no listener";
}

TEST(CollideTest, OnePathIsTakenOnce) {
  const ListenAddress socket = ParseListenAddress("unix:/run/a").value();
  EXPECT_TRUE(Collide(socket, socket));
  EXPECT_FALSE(Collide(socket, ParseListenAddress("unix:/run/b").value()));
  EXPECT_FALSE(Collide(socket, {"::", 7443}));
  EXPECT_FALSE(Collide(socket, ListenAddress()));
}

TEST(IsLoopbackTest, KnowsTheMachineFromTheNetwork) {
  EXPECT_TRUE(IsLoopback({"127.0.0.1", 1}));
  EXPECT_TRUE(IsLoopback({"127.9.9.9", 1}));
  EXPECT_TRUE(IsLoopback({"::1", 1}));
  EXPECT_FALSE(IsLoopback({"::", 1}));
  EXPECT_FALSE(IsLoopback({"0.0.0.0", 1}));
  EXPECT_FALSE(IsLoopback({"128.0.0.1", 1}));
}

}  // namespace
}  // namespace uplink::config
