#include "tools/link/http_client.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/support/certificates.h"

namespace uplink::link {
namespace {

TEST(HttpClient, TheHostHeaderHasThePortUnlessItIsTheSchemesOwn) {
  EXPECT_EQ(HostHeader("127.0.0.1", "7480", false), "127.0.0.1:7480");
  EXPECT_EQ(HostHeader("::1", "7480", false), "[::1]:7480");
  EXPECT_EQ(HostHeader("fleet.example.org", "80", false), "fleet.example.org");
  EXPECT_EQ(HostHeader("::1", "80", false), "[::1]");
  EXPECT_EQ(HostHeader("fleet.example.org", "", false), "fleet.example.org");
  EXPECT_EQ(HostHeader("fleet.example.org", "443", true), "fleet.example.org");
  EXPECT_EQ(HostHeader("fleet.example.org", "443", false), "fleet.example.org:443");
  EXPECT_EQ(HostHeader("fleet.example.org", "80", true), "fleet.example.org:80");
}

TEST(HttpClient, ASocketThatIsNotThereIsNamed) {
  HttpClient client(HttpServer{.address = "/nowhere/http.sock"});
  const absl::Status status = client.Ask("/livez").status();
  EXPECT_EQ(status, absl::UnavailableError("unix:/nowhere/http.sock /livez: connect: No such file "
                                           "or directory"));
  HttpClient long_path(HttpServer{.address = "/" + std::string(107, 'x')});
  EXPECT_TRUE(absl::IsUnavailable(long_path.Ask("/livez").status()));
}

TEST(ServerTls, OnlyPemIsTaken) {
  EXPECT_TRUE(ServerTls::Create({.authorities = ""}).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(ServerTls::Create({.authorities = "x"}).status()));
  const testing::TestAuthority authority;
  const testing::KeyPair one = authority.Issue(testing::ServerSpec());
  const testing::KeyPair two = authority.Issue(testing::ServerSpec());
  EXPECT_TRUE(
      ServerTls::Create(
          {.authorities = authority.certificate(), .certificate = one.certificate, .key = one.key})
          .ok());
  EXPECT_TRUE(absl::IsInvalidArgument(
      ServerTls::Create(
          {.authorities = authority.certificate(), .certificate = one.certificate, .key = two.key})
          .status()));
  EXPECT_TRUE(absl::IsInvalidArgument(
      ServerTls::Create({.authorities = "", .server_certificate = "x"}).status()));
}

TEST(PercentCode, TakesEveryTextThereAndBack) {
  std::string all;
  for (int byte = 0; byte < 256; ++byte) all.push_back(static_cast<char>(byte));
  EXPECT_EQ(PercentDecoded(PercentEncoded(all)), all);
  EXPECT_EQ(PercentDecoded("a%2Fb%2"), "a/b%2");
  EXPECT_EQ(PercentDecoded("%zz%"), "%zz%");
}

}  // namespace
}  // namespace uplink::link
