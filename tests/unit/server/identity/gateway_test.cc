#include "server/identity/gateway.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

Certificate Read(const std::string& pem) {
  auto certificates = ReadCertificates({"test", pem});
  EXPECT_TRUE(certificates.ok()) << certificates.status();
  return std::move(certificates->front());
}

Certificate AuthorityWith(const std::string& name_constraints) {
  const testing::TestAuthority root;
  return Read(testing::TestAuthority("hall", root, name_constraints).certificate());
}

UriConstraints ConstraintsOf(const std::string& words) {
  UriConstraints constraints;
  constraints.Add(*AuthorityWith(words));
  return constraints;
}

TEST(UriConstraints, OfNobodyAllowAll) {
  UriConstraints constraints;
  EXPECT_TRUE(constraints.Allow("rcan://a/1"));
  constraints.Add(*AuthorityWith(""));
  constraints.Add(*AuthorityWith("permitted;DNS:example.org"));
  EXPECT_TRUE(constraints.empty());
  EXPECT_TRUE(constraints.Allow("rcan://@"));
}

TEST(UriConstraints, AHostIsThatHostAlone) {
  const UriConstraints constraints = ConstraintsOf("permitted;URI:example.org");
  EXPECT_TRUE(constraints.Allow("rcan://example.org/acme/rover/1"));
  EXPECT_TRUE(constraints.Allow("rcan://Example.ORG:8443/a"));
  EXPECT_FALSE(constraints.Allow("rcan://a.example.org/1"));
  EXPECT_FALSE(constraints.Allow("rcan://example.org.evil/1"));
}

TEST(UriConstraints, APeriodIsAllBelow) {
  const UriConstraints constraints = ConstraintsOf("permitted;URI:.example.org");
  EXPECT_TRUE(constraints.Allow("rcan://a.example.org/1"));
  EXPECT_TRUE(constraints.Allow("rcan://b.a.example.org"));
  EXPECT_FALSE(constraints.Allow("rcan://example.org/1"));
  EXPECT_FALSE(constraints.Allow("rcan://evilexample.org/1"));
}

TEST(UriConstraints, WhatIsExcludedIsNotAllowed) {
  const UriConstraints constraints =
      ConstraintsOf("permitted;URI:.example.org,excluded;URI:bad.example.org");
  EXPECT_TRUE(constraints.Allow("rcan://good.example.org/1"));
  EXPECT_FALSE(constraints.Allow("rcan://bad.example.org/1"));
  EXPECT_FALSE(constraints.Allow("rcan://bad.example.org?x:y"));
}

TEST(UriConstraints, EachAuthorityMustAllowIt) {
  UriConstraints constraints = ConstraintsOf("permitted;URI:.example.org");
  constraints.Add(*AuthorityWith("permitted;URI:a.example.org,permitted;URI:b.example.org"));
  EXPECT_TRUE(constraints.Allow("rcan://a.example.org/1"));
  EXPECT_TRUE(constraints.Allow("rcan://b.example.org/1"));
  EXPECT_FALSE(constraints.Allow("rcan://c.example.org/1"));
}

TEST(UriConstraints, ANameWithoutAPlainHostIsNotAllowed) {
  const UriConstraints constraints = ConstraintsOf("excluded;URI:bad.example.org");
  EXPECT_TRUE(constraints.Allow("rcan://good.example.org"));
  for (const char* uri : {"", "rcan:good.example.org", "rcan://", "rcan:///1", "rcan://:1/2",
                          "rcan://user@bad.example.org/1"}) {
    EXPECT_FALSE(constraints.Allow(uri)) << uri;
  }
}

/// The same as OpenSSL says of a certificate that names the robot.
TEST(UriConstraints, AgreeWithOpenSslOnNamesOfCertificates) {
  const std::vector<std::string> words = {"permitted;URI:example.org", "permitted;URI:.example.org",
                                          "excluded;URI:example.org", "excluded;URI:.example.org",
                                          "permitted;URI:.org,excluded;URI:a.example.org"};
  const std::vector<std::string> uris = {
      "rcan://example.org/acme/rover/1", "rcan://EXAMPLE.org/1", "rcan://a.example.org/1",
      "rcan://b.a.example.org/1",        "rcan://example.org",   "rcan://example.org:1/2",
      "rcan://notexample.org/1",         "rcan://example.com/1"};
  const testing::TestAuthority issuer;
  for (const std::string& constraint : words) {
    const Certificate authority = AuthorityWith(constraint);
    const std::unique_ptr<NAME_CONSTRAINTS, decltype(&NAME_CONSTRAINTS_free)> names(
        static_cast<NAME_CONSTRAINTS*>(
            X509_get_ext_d2i(authority.get(), NID_name_constraints, nullptr, nullptr)),
        NAME_CONSTRAINTS_free);
    ASSERT_NE(names, nullptr);
    for (const std::string& uri : uris) {
      const Certificate robot = Read(issuer.Issue(testing::RobotSpec(uri)).certificate);
      // Reads its names.
      ASSERT_NE(X509_check_purpose(robot.get(), -1, 0), -1);
      EXPECT_EQ(ConstraintsOf(constraint).Allow(uri),
                NAME_CONSTRAINTS_check(robot.get(), names.get()) == X509_V_OK)
          << constraint << " " << uri;
    }
  }
}

TEST(Gateway, MaySpeakForThoseItNamesOrForAll) {
  Gateway gateway;
  EXPECT_TRUE(gateway.MaySpeakFor("rcan://example.org/r1"));
  EXPECT_FALSE(gateway.Names("rcan://example.org/r1"));
  gateway.ruris = {"rcan://another"};
  EXPECT_FALSE(gateway.MaySpeakFor("rcan://example.org/r1"));
  gateway.ruris.emplace_back("rcan://example.org/r1");
  EXPECT_TRUE(gateway.MaySpeakFor("rcan://example.org/r1"));
  EXPECT_TRUE(gateway.Names("rcan://example.org/r1"));
}

}  // namespace
}  // namespace uplink::identity
