#include "server/http/source.h"

#include <array>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>

namespace uplink::http {
namespace {

Source Of(const std::string& text) {
  std::array<std::uint8_t, 16> address{};
  EXPECT_EQ(inet_pton(AF_INET6, text.c_str(), address.data()), 1) << text;
  return SourceOf(address);
}

TEST(SourceTest, EachIpv4AddressIsOne) {
  EXPECT_EQ(Of("::ffff:192.0.2.1"), Of("::ffff:192.0.2.1"));
  EXPECT_NE(Of("::ffff:192.0.2.1"), Of("::ffff:192.0.2.2"));
  EXPECT_NE(Of("::ffff:192.0.2.1"), Source());
}

TEST(SourceTest, AllIpv6AddressesOfA64AreOne) {
  EXPECT_EQ(Of("2001:db8:1:2::1"), Of("2001:db8:1:2:ffff:ffff:ffff:ffff"));
  EXPECT_NE(Of("2001:db8:1:2::1"), Of("2001:db8:1:3::1"));
}

}  // namespace
}  // namespace uplink::http
