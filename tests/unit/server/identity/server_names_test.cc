#include "server/identity/server_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

NamedPem Issued(const testing::CertificateSpec& spec) {
  return {"server.crt", testing::TestAuthority().Issue(spec).certificate};
}

TEST(ServerNamesTest, AreTheHostsOfSubjectAltNameAlone) {
  testing::CertificateSpec spec;
  spec.common_names = {"common.example.org"};
  spec.uris = {"rcan://a"};
  spec.dns_names = {"uplink.example.org", "*.example.org"};
  spec.ip_addresses = {"192.0.2.7", "2001:db8::7"};
  const auto names = ServerNamesOf(Issued(spec));
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ::testing::UnorderedElementsAre("uplink.example.org", "*.example.org",
                                                      "192.0.2.7", "2001:db8::7"));
}

TEST(ServerNamesTest, AreOfTheFirstCertificate) {
  testing::CertificateSpec spec;
  spec.dns_names = {"leaf"};
  testing::CertificateSpec other;
  other.dns_names = {"other"};
  const auto names = ServerNamesOf({"chain", Issued(spec).text + Issued(other).text});
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ElementsAre("leaf"));
}

TEST(ServerNamesTest, ACommonNameIsNone) {
  testing::CertificateSpec spec;
  spec.common_names = {"uplink.example.org"};
  const auto names = ServerNamesOf(Issued(spec));
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, IsEmpty());
}

TEST(ServerNamesTest, ATextWithoutACertificateIsAnError) {
  EXPECT_FALSE(ServerNamesOf({"server.crt", "no certificate"}).ok());
}

}  // namespace
}  // namespace uplink::identity
