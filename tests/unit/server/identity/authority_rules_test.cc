#include "server/identity/authority_rules.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <openssl/asn1.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

class AuthorityRulesTest : public ::testing::Test {
 protected:
  static Certificate Read(const testing::TestAuthority& authority) {
    auto read = ReadCertificates({"ca.crt", authority.certificate()});
    EXPECT_TRUE(read.ok()) << read.status();
    return read.ok() ? std::move(read->front()) : nullptr;
  }
  void Add(const AuthorityRule& rule) {
    ASSERT_TRUE(rules_.Add({"north.pem", authority_.certificate()}, rule).ok());
  }
  [[nodiscard]] std::string Flaw(Role role, const std::string& fleet) const {
    return std::string(rules_.Judge({.role = role, .fleet = fleet}, *certificate_).message());
  }

  const testing::TestAuthority authority_{"test authority"};
  const Certificate certificate_ = Read(authority_);
  AuthorityRules rules_;
};

TEST_F(AuthorityRulesTest, OneWithoutARuleMayVouchForAll) {
  EXPECT_EQ(Flaw(Role::kAdmin, "*"), "");
  Add({.name = "north"});
  EXPECT_EQ(Flaw(Role::kAdmin, "*"), "");
  EXPECT_EQ(Flaw(Role::kRobot, "south"), "");
}

TEST_F(AuthorityRulesTest, ARoleThatIsNotNamedIsOutside) {
  Add({.name = "north", .roles = {Role::kRobot, Role::kGateway}});
  EXPECT_EQ(Flaw(Role::kRobot, "south"), "");
  EXPECT_EQ(Flaw(Role::kViewer, "south"),
            "client certificate: its authority north may not vouch for the role viewer");
}

TEST_F(AuthorityRulesTest, AFleetThatIsNotNamedIsOutside) {
  Add({.name = "north", .fleets = Scope::Of({"north"})});
  EXPECT_EQ(Flaw(Role::kRobot, "north"), "");
  EXPECT_EQ(Flaw(Role::kRobot, "south"),
            "client certificate: its authority north may not vouch for the fleet south");
  EXPECT_EQ(Flaw(Role::kAdmin, "*"),
            "client certificate: its authority north may not vouch for the fleet *");
}

TEST_F(AuthorityRulesTest, TheCertificateCountsAndNotItsName) {
  Add({.name = "north", .fleets = Scope::Of({"north"})});
  const testing::TestAuthority namesake("test authority");
  const Certificate other = Read(namesake);
  EXPECT_TRUE(rules_.Judge({.role = Role::kRobot, .fleet = "south"}, *other).ok());
}

TEST_F(AuthorityRulesTest, ARenewedCertificateOfTheSameNameAndKeyHasItsRule) {
  Add({.name = "north", .fleets = Scope::Of({"north"})});
  const Certificate renewed = Read(authority_);
  ASSERT_EQ(ASN1_INTEGER_set(X509_get_serialNumber(renewed.get()), 77), 1);
  ASSERT_GT(i2d_re_X509_tbs(renewed.get(), nullptr), 0);
  ASSERT_NE(DigestOf(*renewed), DigestOf(*certificate_));
  EXPECT_TRUE(rules_.Has(*renewed));
  EXPECT_FALSE(rules_.Judge({.role = Role::kRobot, .fleet = "south"}, *renewed).ok());
}

TEST_F(AuthorityRulesTest, OneThatAnotherHasSignedKeepsItsRule) {
  const testing::TestAuthority hall("hall", authority_);
  ASSERT_TRUE(
      rules_.Add({"hall.pem", hall.certificate()}, {.name = "hall", .roles = {Role::kRobot}}).ok());
  const Certificate signed_one = Read(hall);
  STACK_OF(X509)* const chain = sk_X509_new_null();
  sk_X509_push(chain, signed_one.get());
  sk_X509_push(chain, certificate_.get());
  EXPECT_TRUE(rules_.Judge({.role = Role::kRobot, .fleet = "south"}, chain).ok());
  EXPECT_EQ(rules_.Judge({.role = Role::kAdmin, .fleet = "*"}, chain).message(),
            "client certificate: its authority hall may not vouch for the role admin");
  sk_X509_free(chain);
}

TEST_F(AuthorityRulesTest, ACertificateHasOneRule) {
  Add({.name = "north"});
  const absl::Status again = rules_.Add({"south.pem", authority_.certificate()}, {.name = "south"});
  EXPECT_EQ(again.message(), "south.pem: its certificate is also in north; keep one of them");
}

TEST(RoleOf, KnowsEachRole) {
  for (const Role role : {Role::kRobot, Role::kGateway, Role::kViewer, Role::kOperator,
                          Role::kAdmin, Role::kMetrics}) {
    EXPECT_EQ(RoleOf(ToText(role)), role);
  }
  EXPECT_EQ(RoleOf("root"), std::nullopt);
}

}  // namespace
}  // namespace uplink::identity
