#include "tools/link/http_client.h"

#include <gtest/gtest.h>

namespace uplink::link {
namespace {

TEST(HttpClient, TheHostHeaderHasThePortUnlessItIs80) {
  EXPECT_EQ(HostHeader("127.0.0.1", "7480"), "127.0.0.1:7480");
  EXPECT_EQ(HostHeader("::1", "7480"), "[::1]:7480");
  EXPECT_EQ(HostHeader("fleet.example.org", "80"), "fleet.example.org");
  EXPECT_EQ(HostHeader("::1", "80"), "[::1]");
  EXPECT_EQ(HostHeader("fleet.example.org", ""), "fleet.example.org");
}

}  // namespace
}  // namespace uplink::link
