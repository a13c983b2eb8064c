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

}  // namespace
}  // namespace uplink::http
