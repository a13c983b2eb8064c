#include "tools/uplinkctl/ask/server_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Read(const std::string& url) {
  const auto parsed = ParseServerUrl(url, "--server");
  return parsed.ok() ? ToText(*parsed) : std::string(parsed.status().message());
}

TEST(ServerUrl, HasAnAddressAndPerhapsAPath) {
  EXPECT_EQ(Read("http://127.0.0.1:7480"), "http://127.0.0.1:7480");
  EXPECT_EQ(Read("http://a"), "http://a:80");
  EXPECT_EQ(Read("https://a"), "https://a:443");
  EXPECT_EQ(Read("http://[::1]"), "http://[::1]:80");
  EXPECT_EQ(Read("http://[::1]:65535/"), "http://[::1]:65535");
  EXPECT_EQ(Read("https://a:8443/fleet/"), "https://a:8443/fleet");
  EXPECT_EQ(Read("unix:/run/uplinkd/http.sock"), "unix:/run/uplinkd/http.sock");
}

TEST(ServerUrl, ItsPartsAreReadApart) {
  const auto url = ParseServerUrl("https://a:1/fleet", "x");
  ASSERT_TRUE(url.ok()) << url.status();
  EXPECT_EQ(url->address, "a:1");
  EXPECT_EQ(url->prefix, "/fleet");
  EXPECT_TRUE(url->tls);
  const auto socket = ParseServerUrl("unix:/a", "x");
  ASSERT_TRUE(socket.ok()) << socket.status();
  EXPECT_EQ(socket->address, "/a");
  EXPECT_FALSE(socket->tls);
}

TEST(ServerUrl, AnythingElseIsWrongUse) {
  for (const char* url : {"",
                          "127.0.0.1:7480",
                          "ftp://a",
                          "http://",
                          "https://",
                          "http://:80",
                          "http://[]:80",
                          "http://[::1",
                          "http://::1:80",
                          "http://a:0",
                          "http://a:65536",
                          "http://a:b",
                          "http://a:",
                          "http://u@a:1",
                          "http://a:1?b",
                          "http://a:1/?x",
                          "http://a:1/b c",
                          "unix:",
                          "unix:a",
                          "unix:/",
                          "unix:/a/"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(ParseServerUrl(url, "x").status())) << url;
  }
}

TEST(ServerUrl, APasswordIsNotRepeated) {
  EXPECT_THAT(Read("https://ann:pass-word@a:1"), HasSubstr("neither user nor password"));
  EXPECT_THAT(Read("https://ann:pass-word@a:1"), Not(HasSubstr("pass-word")));
}

}  // namespace
}  // namespace uplink::ctl
