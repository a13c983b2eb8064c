#include "server/http/known_hosts.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

TEST(KnownHosts, AreAddressesLocalhostAndTheNamesOfTheSetting) {
  const KnownHosts hosts({"uplink.example.org", "Robots"});
  for (const char* host : {"127.0.0.1", "127.0.0.1:7480", "192.0.2.7:1", "[::1]", "[::1]:7480",
                           "[2001:db8::7]:80", "localhost", "LocalHost:7480", "uplink.example.org",
                           "UPLINK.example.org:443", "robots", "localhost:"}) {
    EXPECT_TRUE(hosts.Has(host)) << host;
  }
}

TEST(KnownHosts, AreNothingElse) {
  const KnownHosts hosts({"uplink.example.org"});
  for (const char* host :
       {"", "rebound.example", "uplink.example.org.evil.example", "evil.uplink.example.org",
        "localhost.evil.example", "127.0.0.1.evil.example", "127.1", "0x7f.1", "::1", "[::1",
        "[evil]", "[127.0.0.1]", "localhost:80x", "localhost:80:80", "uplink.example.org ", ":80",
        "127.0.0.1@evil.example"}) {
    EXPECT_FALSE(hosts.Has(host)) << host;
  }
  EXPECT_FALSE(KnownHosts().Has("uplink.example.org"));
}

TEST(KnownHosts, KnowTheOriginOfAPageOfOurs) {
  const KnownHosts hosts({"uplink.example.org"});
  for (const char* origin : {"http://127.0.0.1:7480", "https://127.0.0.1", "http://localhost:3000",
                             "https://UPLINK.example.org", "https://uplink.example.org:8443"}) {
    EXPECT_TRUE(hosts.HasOrigin(origin, "127.0.0.1:7480")) << origin;
  }
  EXPECT_TRUE(hosts.HasOrigin("http://[::1]:3000", "[::1]:7480"));
  EXPECT_TRUE(hosts.HasOrigin("http://[2001:DB8::7]", "[2001:db8::7]:80"));
}

TEST(KnownHosts, KnowNoOtherOrigin) {
  const KnownHosts hosts({"uplink.example.org"});
  for (const char* origin :
       {"", "null", "https://evil.example", "http://127.0.0.1.evil.example", "http://192.0.2.7",
        "http://evil.uplink.example.org", "http://localhost@evil.example", "http://", "file://",
        "127.0.0.1:7480", "http://127.0.0.1:x", "http://[::1", "http://[::1]"}) {
    EXPECT_FALSE(hosts.HasOrigin(origin, "127.0.0.1:7480")) << origin;
  }
  EXPECT_FALSE(hosts.HasOrigin("http://[", "[")) << "what is no host is like no host";
  EXPECT_FALSE(hosts.HasOrigin("http://", ""));
}

}  // namespace
}  // namespace uplink::http
