#include "tools/uplinkctl/doctor/certificate_check.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/identity/expiry.h"
#include "tests/support/certificates.h"
#include "tools/uplinkctl/doctor/certificate_facts.h"

namespace uplink::ctl {
namespace {

using std::chrono::days;
using ::testing::HasSubstr;
using testing::ServerSpec;
using testing::TestAuthority;

constexpr SystemTime kNow = FromUnixMs(1'800'000'000'000);

ServerCertificate Certificate() {
  ServerCertificate certificate{.file = {"tls.certificate_file", "/s.crt"}, .facts = {}};
  certificate.facts.chain.push_back({"CN=s", kNow - days(1), kNow + days(100)});
  certificate.facts.trust = Trust::kOwnAuthority;
  certificate.facts.issuer = "CN=ca";
  certificate.facts.names = {"fleet.example.org"};
  return certificate;
}

Finding Worst(const ServerCertificate& certificate) {
  const Findings findings = ServerCertificateFindings(certificate, kNow);
  return *std::max_element(
      findings.begin(), findings.end(),
      [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
}

TEST(CertificateCheck, AGoodOneSaysHowLongAndForWhom) {
  const Findings findings = ServerCertificateFindings(Certificate(), kNow);
  EXPECT_EQ(ExitOfFindings(findings), 0);
  EXPECT_THAT(findings.front().what, HasSubstr("/s.crt expires in 100 days, at 2027-04-25T"));
  EXPECT_THAT(findings.back().what, HasSubstr("it is for fleet.example.org"));
}

TEST(CertificateCheck, TheLastDaysAreAWarning) {
  ServerCertificate certificate = Certificate();
  SystemTime& end = certificate.facts.chain.front().end;
  end = kNow + kExpirySoon;
  EXPECT_EQ(Worst(certificate).severity, Severity::kOk);
  end -= milliseconds(1);
  EXPECT_EQ(Worst(certificate).severity, Severity::kWarning);
  end = kNow + milliseconds(1);
  EXPECT_EQ(Worst(certificate).severity, Severity::kWarning);
  end = kNow;
  EXPECT_EQ(Worst(certificate).severity, Severity::kError);
  EXPECT_THAT(Worst(certificate).remedy, HasSubstr("renew it"));
}

TEST(CertificateCheck, OneThatIsNotValidYetIsAnError) {
  ServerCertificate certificate = Certificate();
  certificate.facts.chain.front().begin = kNow + milliseconds(1);
  EXPECT_EQ(Worst(certificate).severity, Severity::kError);
  EXPECT_THAT(Worst(certificate).what, HasSubstr("is not valid before"));
}

TEST(CertificateCheck, AnExpiredIntermediateIsNamed) {
  ServerCertificate certificate = Certificate();
  certificate.facts.chain.push_back({"CN=between", kNow - days(9), kNow - days(2)});
  EXPECT_THAT(Worst(certificate).what, HasSubstr("CN=between behind the server's, expired 2 days"));
}

TEST(CertificateCheck, WhereTheChainLeadsIsJudged) {
  ServerCertificate certificate = Certificate();
  for (const Trust good : {Trust::kOwnAuthority, Trust::kSystem, Trust::kElsewhere}) {
    certificate.facts.trust = good;
    EXPECT_EQ(Worst(certificate).severity, Severity::kOk);
  }
  certificate.facts.trust = Trust::kOtherKey;
  EXPECT_THAT(Worst(certificate).what, HasSubstr("was not signed by the authority CN=ca"));
  certificate.facts.trust = Trust::kBroken;
  EXPECT_THAT(Worst(certificate).what, HasSubstr("not signed by the one behind it"));
}

TEST(CertificateCheck, NamesThatOnlyThisMachineHasAreAWarningIfOthersAreServed) {
  ServerCertificate certificate = Certificate();
  certificate.facts.names = {"localhost", "127.0.0.1", "::1"};
  EXPECT_EQ(Worst(certificate).severity, Severity::kOk);
  certificate.serves_others = true;
  EXPECT_EQ(Worst(certificate).severity, Severity::kWarning);
  certificate.facts.names.emplace_back("192.0.2.1");
  EXPECT_EQ(Worst(certificate).severity, Severity::kOk);
  certificate.facts.names.clear();
  EXPECT_EQ(Worst(certificate).severity, Severity::kError);
}

TEST(CertificateCheck, AnExpiredAuthorityIsAnErrorIfItIsTheOnlyOne) {
  const CertificateFacts expired{"CN=old", kNow - days(9), kNow - days(1)};
  const CertificateFacts good{"CN=new", kNow - days(9), kNow + days(900)};
  EXPECT_EQ(ExitOfFindings(AuthorityFindings({"tls.client_ca_file", "/ca"}, {expired}, kNow)),
            kExitErrors);
  EXPECT_EQ(ExitOfFindings(AuthorityFindings({"tls.client_ca_file", "/ca"}, {expired, good}, kNow)),
            kExitWarnings);
  EXPECT_EQ(ExitOfFindings(AuthorityFindings({"tls.client_ca_file", "/ca"}, {good}, kNow)), 0);
}

TEST(CertificateCheck, AuthoritiesThatAreGoodSayUntilWhen) {
  const auto line = [](const std::vector<CertificateFacts>& authorities) {
    return AuthorityFindings({"tls.client_ca_file", "/ca"}, authorities, kNow).front().what;
  };
  const CertificateFacts first{"CN=first", kNow - days(9), kNow + days(100)};
  const CertificateFacts last{"CN=last", kNow - days(9), kNow + days(900)};
  const CertificateFacts expired{"CN=old", kNow - days(9), kNow - days(1)};
  EXPECT_EQ(line({expired, first}),
            "/ca has 1 authority that did not expire, good until 2027-04-25T08:00:00Z");
  EXPECT_EQ(line({last, first}),
            "/ca has 2 authorities that did not expire, good until 2027-04-25T08:00:00Z");
  EXPECT_EQ(line({{"CN=ever", kNow - days(9), identity::kNoExpiry}}),
            "/ca has 1 authority that did not expire");
}

TEST(CertificateCheck, AnAuthorityThatEndsIsToBeExtendedWithItsKey) {
  for (const SystemTime end : {kNow - days(1), kNow + days(1)}) {
    const Findings findings =
        AuthorityFindings({"tls.client_ca_file", "/ca"}, {{"CN=a", kNow - days(9), end}}, kNow);
    EXPECT_THAT(findings.back().remedy, HasSubstr("extend it with the same key"));
  }
}

TEST(CertificateCheck, AListThatIsOverIsAWarning) {
  const NamedFile file{"tls.client_crl_file", "/lists"};
  identity::RevocationList list{.issuer = "CN=ca", .revoked = {}, .next_update = {}};
  EXPECT_TRUE(ListFindings(file, {list}, kNow).empty()) << "no next one was promised";
  list.next_update = kNow + milliseconds(1);
  EXPECT_TRUE(ListFindings(file, {list}, kNow).empty());
  list.next_update = kNow;
  const Findings findings = ListFindings(file, {list}, kNow);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings.front().severity, Severity::kWarning);
  EXPECT_THAT(findings.front().what, HasSubstr("the list of CN=ca in /lists is over since"));
}

TEST(CertificateFacts, ARealChainIsReadWithItsNames) {
  const TestAuthority authority;
  const auto chain =
      ReadChain({"s", authority.Issue(ServerSpec()).certificate}, {"ca", authority.certificate()});
  ASSERT_TRUE(chain.has_value());
  EXPECT_EQ(chain->chain.size(), 1U);
  EXPECT_EQ(chain->trust, Trust::kOwnAuthority);
  EXPECT_EQ(chain->chain.front().end - chain->chain.front().begin, std::chrono::hours(2));
  EXPECT_THAT(chain->names, ::testing::IsSupersetOf({"localhost", "127.0.0.1"}));
}

TEST(CertificateFacts, AnAuthorityOfTheSameNameIsToldFromTheRightOne) {
  const TestAuthority right("ca");
  const TestAuthority other("ca");
  const TestAuthority stranger("stranger");
  const std::string certificate = right.Issue(ServerSpec()).certificate;
  EXPECT_EQ(ReadChain({"s", certificate}, {"ca", other.certificate()})->trust, Trust::kOtherKey);
  EXPECT_EQ(ReadChain({"s", certificate}, {"ca", stranger.certificate()})->trust,
            Trust::kElsewhere);
}

TEST(CertificateFacts, AnIntermediateCompletesTheChain) {
  const TestAuthority root("root");
  const TestAuthority between("between", root);
  const std::string leaf = between.Issue(ServerSpec()).certificate;
  EXPECT_EQ(ReadChain({"s", leaf + between.certificate()}, {"ca", root.certificate()})->trust,
            Trust::kOwnAuthority);
  EXPECT_EQ(
      ReadChain({"s", leaf + root.certificate()}, {"ca", TestAuthority("x").certificate()})->trust,
      Trust::kBroken);
}

TEST(CertificateFacts, WhatIsNotPemHasNone) {
  EXPECT_FALSE(ReadChain({"s", "nothing"}, {"ca", ""}).has_value());
  EXPECT_TRUE(ReadFacts({"s", ""}).empty());
}

}  // namespace
}  // namespace uplink::ctl
