#include "server/identity/peer_identity.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/identity/pem.h"
#include "server/identity/ruri.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using uplink::testing::CertificateSpec;
using uplink::testing::RobotSpec;
using uplink::testing::TestAuthority;

constexpr char kRuri[] = "rcan://example.org/acme/rover/r1";

absl::StatusOr<PeerIdentity> IdentityOf(const CertificateSpec& spec) {
  const TestAuthority authority;
  const auto certificates = ReadCertificates({"issued", authority.Issue(spec).certificate});
  if (!certificates.ok()) return certificates.status();
  return identity::IdentityOf(*certificates->front());
}

CertificateSpec OperatorSpec(const std::string& unit) {
  CertificateSpec spec;
  spec.organizations = {"acme"};
  spec.units = {unit};
  return spec;
}

/// Expects the refusal, whose sentence must contain `text`.
void ExpectWrong(const CertificateSpec& spec, const std::string& text) {
  const auto identity = IdentityOf(spec);
  ASSERT_FALSE(identity.ok()) << "expected: " << text;
  EXPECT_EQ(identity.status().code(), absl::StatusCode::kUnauthenticated);
  EXPECT_THAT(std::string(identity.status().message()), HasSubstr(text));
}

TEST(PeerIdentity, RobotOfAFleet) {
  const auto identity = IdentityOf(RobotSpec(kRuri, "acme"));
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->role, Role::kRobot);
  EXPECT_EQ(identity->fleet, "acme");
  EXPECT_EQ(identity->ruri, kRuri);
}

TEST(PeerIdentity, RobotWithoutOrganizationIsOfTheDefaultFleet) {
  const auto identity = IdentityOf(RobotSpec(kRuri));
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->fleet, "default");
}

TEST(PeerIdentity, RobotMayNameItsRole) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.units = {"robot"};
  const auto identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->role, Role::kRobot);
}

TEST(PeerIdentity, NamesThatAreNoRuriDoNotCount) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.uris = {"spiffe://example.org/r1", kRuri, "https://example.org/"};
  spec.dns_names = {"rcan.example.org"};
  const auto identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->ruri, kRuri);
}

TEST(PeerIdentity, CommonNameIsNoIdentity) {
  CertificateSpec spec;
  spec.common_names = {kRuri};
  ExpectWrong(spec, "has no URI name that begins rcan://");
}

TEST(PeerIdentity, DnsNameIsNoIdentity) {
  CertificateSpec spec;
  spec.dns_names = {kRuri};
  ExpectWrong(spec, "has no URI name that begins rcan://");
}

TEST(PeerIdentity, RobotWithTwoRuris) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.uris.emplace_back("rcan://example.org/acme/rover/r2");
  ExpectWrong(spec, "has 2 rcan:// URIs instead of one");
}

TEST(PeerIdentity, RuriAtItsLimit) {
  const std::string ruri = "rcan://" + std::string(256 - 7, 'x');
  const auto identity = IdentityOf(RobotSpec(ruri));
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->ruri, ruri);
}

TEST(PeerIdentity, RuriPastItsLimit) {
  ExpectWrong(RobotSpec("rcan://" + std::string(257 - 7, 'x')), "has 257 bytes, the limit is 256");
}

TEST(PeerIdentity, RuriThatNamesNothing) { ExpectWrong(RobotSpec("rcan://"), "names nothing"); }

constexpr const char* kTwin =
    "rcan://local.rcan/cyberwave/twin/3f2504e0-4f89-11d3-9a0c-0305e82c3301";

TEST(PeerIdentity, ATwinIsNamedByNoCertificate) {
  for (const std::string& ruri : {std::string(kTwin), std::string(kTwin) + "?sig=x",
                                  std::string("rcan://local.rcan/cyberwave/sim/T"),
                                  std::string("rcan://local.rcan/cyberwave/twin.site%2F/T"),
                                  std::string("rcan://local.rcan/cyberwave/sim.site/T")}) {
    ExpectWrong(RobotSpec(ruri), "is a twin's, and twins are heard through their broker alone");
    CertificateSpec gateway = OperatorSpec("gateway");
    gateway.uris = {kRuri, ruri};
    ExpectWrong(gateway, "is a twin's");
  }
  for (const char* ruri :
       {"rcan://local.rcan/cyberwave/twins/T", "rcan://local.rcan/cyberwave/arm/1",
        "rcan://other.rcan/cyberwave/twin/T", "rcan://local.rcan/acme/twin/T"}) {
    EXPECT_TRUE(IdentityOf(RobotSpec(ruri)).ok()) << ruri;
  }
}

TEST(Ruri, ATwinsShorthandIsWrittenOut) {
  EXPECT_TRUE(NamesTwin("cyberwave.twin.T"));
  EXPECT_TRUE(NamesTwin(kTwin));
  EXPECT_FALSE(NamesTwin("cyberwave.arm.T"));
}

TEST(PeerIdentity, RuriInAnotherCaseIsNone) {
  ExpectWrong(RobotSpec("RCAN://example.org/r1"), "has no URI name that begins rcan://");
}

TEST(PeerIdentity, RuriWithUncleanBytes) {
  for (const char* tail : {"a b", "a\tb", "a\nb", "a\x7f", "\x1b[31m", "\xc3\xa9"}) {
    ExpectWrong(RobotSpec(std::string("rcan://") + tail), "white space, a control character");
  }
}

TEST(PeerIdentity, RefusalRepeatsUncleanBytesPrintable) {
  ExpectWrong(RobotSpec("rcan://a\nb"), "rcan://a\\x0ab");
}

TEST(PeerIdentity, RuriWithNul) {
  ExpectWrong(RobotSpec(std::string("rcan://good\0.evil", 17)), "rcan:// URI holds a NUL byte");
}

TEST(PeerIdentity, NoExtendedKeyUsage) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.key_usages.clear();
  ExpectWrong(spec, "has no extended key usage clientAuth");
}

TEST(PeerIdentity, ExtendedKeyUsageOfAServer) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.key_usages = {"serverAuth"};
  ExpectWrong(spec, "lacks clientAuth");
}

TEST(PeerIdentity, AnyExtendedKeyUsageIsNotEnough) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.key_usages = {"anyExtendedKeyUsage"};
  ExpectWrong(spec, "lacks clientAuth");
}

TEST(PeerIdentity, ClientAuthAmongOthers) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.key_usages = {"serverAuth", "clientAuth"};
  EXPECT_TRUE(IdentityOf(spec).ok());
}

TEST(PeerIdentity, SeveralOrganizations) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.organizations = {"acme", "other"};
  ExpectWrong(spec, "more than one O");
}

TEST(PeerIdentity, SeveralUnits) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.units = {"robot", "admin"};
  ExpectWrong(spec, "more than one OU");
}

TEST(PeerIdentity, UnknownUnit) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.units = {"Robot"};
  ExpectWrong(spec, "its OU is Robot, which is no role");
}

TEST(PeerIdentity, NulInSubject) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.units = {std::string("robot\0x", 7)};
  ExpectWrong(spec, "the OU of its subject holds a NUL byte");
  spec.units.clear();
  spec.organizations = {std::string("acme\0x", 6)};
  ExpectWrong(spec, "the O of its subject holds a NUL byte");
}

TEST(PeerIdentity, ControlCharacterInFleet) {
  ExpectWrong(RobotSpec(kRuri, "ac\nme"), "its O holds a control character: ac\\x0ame");
}

TEST(PeerIdentity, FleetBeyondAscii) {
  const auto identity = IdentityOf(RobotSpec(kRuri, "K\xc3\xb6ln"));
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->fleet, "K\xc3\xb6ln");
}

TEST(PeerIdentity, FleetLimit) {
  EXPECT_TRUE(IdentityOf(RobotSpec(kRuri, std::string(256, 'f'))).ok());
  ExpectWrong(RobotSpec(kRuri, std::string(257, 'f')), "its O has 257 bytes, the limit is 256");
}

TEST(PeerIdentity, RobotOfAllFleets) { ExpectWrong(RobotSpec(kRuri, "*"), "its O is *"); }

TEST(PeerIdentity, GatewayWithoutAndWithRuris) {
  CertificateSpec spec = OperatorSpec("gateway");
  auto identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->role, Role::kGateway);
  EXPECT_THAT(identity->gateway.ruris, IsEmpty());
  spec.uris = {kRuri, "rcan://example.org/r2"};
  identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_THAT(identity->gateway.ruris, ElementsAre(kRuri, "rcan://example.org/r2"));
}

TEST(PeerIdentity, TheSubjectOfAGatewayIsKept) {
  CertificateSpec spec = OperatorSpec("gateway");
  spec.common_names = {"hall 3, \n\x01"};
  const auto identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->gateway.subject.find('\n'), std::string::npos);
  EXPECT_THAT(identity->gateway.subject, ::testing::HasSubstr("hall 3"));
  EXPECT_THAT(identity->gateway.subject, ::testing::HasSubstr("OU=gateway"));
  EXPECT_THAT(identity->gateway.subject, ::testing::HasSubstr("O=acme"));
  spec.organizations = {std::string(256, 'f')};
  const auto cut = IdentityOf(spec);
  ASSERT_TRUE(cut.ok()) << cut.status();
  EXPECT_LE(cut->gateway.subject.size(), kSubjectBytesMax);
  const auto robot = IdentityOf(RobotSpec(kRuri));
  ASSERT_TRUE(robot.ok()) << robot.status();
  EXPECT_EQ(robot->gateway.subject, "") << "a robot needs none";
}

TEST(PeerIdentity, GatewayWithAnUncleanRuri) {
  CertificateSpec spec = OperatorSpec("gateway");
  spec.uris = {kRuri, "rcan://a b"};
  ExpectWrong(spec, "white space");
}

TEST(PeerIdentity, OperatorRoles) {
  for (const Role role : kAskingRoles) {
    const auto identity = IdentityOf(OperatorSpec(std::string(ToText(role))));
    ASSERT_TRUE(identity.ok()) << identity.status();
    EXPECT_EQ(identity->role, role);
    EXPECT_EQ(identity->fleet, "acme");
    EXPECT_EQ(identity->ruri, "");
    EXPECT_THAT(identity->gateway.ruris, IsEmpty());
  }
}

TEST(PeerIdentity, OperatorOfAllFleets) {
  CertificateSpec spec = OperatorSpec("viewer");
  spec.organizations = {"*"};
  const auto identity = IdentityOf(spec);
  ASSERT_TRUE(identity.ok()) << identity.status();
  EXPECT_EQ(identity->fleet, "*");
}

TEST(PeerIdentity, OperatorWithARuri) {
  CertificateSpec spec = OperatorSpec("operator");
  spec.uris = {kRuri};
  ExpectWrong(spec, "its OU is operator and it has an rcan:// URI");
}

}  // namespace
}  // namespace uplink::identity
