#include "server/identity/deny_list.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using storage::RevokedBy;

Certificate CertificateOf(const testing::KeyPair& keys) {
  auto read = ReadCertificates({"a.crt", keys.certificate});
  EXPECT_TRUE(read.ok()) << read.status();
  return read.ok() ? std::move(read->front()) : nullptr;
}

struct ChainFree {
  void operator()(STACK_OF(X509) * chain) const { sk_X509_free(chain); }
};

/// Its certificates stay those of the caller.
std::unique_ptr<STACK_OF(X509), ChainFree> ChainOf(const std::vector<X509*>& certificates) {
  std::unique_ptr<STACK_OF(X509), ChainFree> chain(sk_X509_new_null());
  for (X509* const each : certificates) sk_X509_push(chain.get(), each);
  return chain;
}

TEST(DenyList, NothingIsDeniedAtFirst) {
  const DenyList list;
  ASSERT_NE(list.Get(), nullptr);
  EXPECT_EQ(list.Get()->size(), 0U);
}

TEST(DenyList, TheListThatWasTakenStays) {
  DenyList list;
  const DeniedPtr before = list.Get();
  auto denied = std::make_shared<DeniedCertificates>();
  ASSERT_TRUE(denied->Add(RevokedBy::kIssuerSerial, "0A CN=a"));
  list.Set(denied);
  EXPECT_EQ(before->size(), 0U);
  EXPECT_EQ(list.Get()->size(), 1U);
}

TEST(DeniedCertificates, TakeEachKindAndNoOther) {
  DeniedCertificates denied;
  for (const RevokedBy by : storage::kAllRevokedBy) {
    const bool is_serial = by == RevokedBy::kIssuerSerial;
    EXPECT_TRUE(denied.Add(by, is_serial ? "0A CN=a" : std::string(64, 'a')));
    EXPECT_FALSE(denied.Add(by, "a")) << "no value of its kind";
  }
  EXPECT_EQ(denied.size(), storage::kAllRevokedBy.size());
  const auto unknown = static_cast<RevokedBy>(storage::kAllRevokedBy.size());
  EXPECT_FALSE(denied.Add(unknown, std::string(64, 'b')));
  EXPECT_EQ(denied.size(), storage::kAllRevokedBy.size());
}

TEST(DeniedCertificates, AreNamedByEitherDigest) {
  const testing::TestAuthority authority;
  const Certificate certificate = CertificateOf(authority.Issue(testing::RobotSpec("rcan://a/1")));
  const ShownCertificate shown = ShownBy(*certificate);
  const storage::CertificateFacts facts = FactsOf(shown);
  DeniedCertificates by_key;
  ASSERT_TRUE(by_key.Add(RevokedBy::kKey, facts.key_sha256));
  EXPECT_TRUE(by_key.NamesDigest(shown));
  DeniedCertificates by_certificate;
  ASSERT_TRUE(by_certificate.Add(RevokedBy::kCertificate, facts.sha256));
  EXPECT_TRUE(by_certificate.NamesDigest(shown));
  DeniedCertificates others;
  ASSERT_TRUE(others.Add(RevokedBy::kKey, facts.sha256));
  ASSERT_TRUE(others.Add(RevokedBy::kCertificate, facts.key_sha256));
  EXPECT_FALSE(others.NamesDigest(shown));
}

TEST(DeniedCertificates, NoCertificateIsNamedByNothing) {
  DeniedCertificates denied;
  ASSERT_TRUE(denied.Add(RevokedBy::kKey, std::string(64, '0')));
  EXPECT_FALSE(denied.NamesDigest({}));
}

TEST(DeniedCertificates, ASerialIsOfItsIssuer) {
  DeniedCertificates denied;
  ASSERT_TRUE(denied.Add(RevokedBy::kIssuerSerial, "0A CN=north,O=a b"));
  EXPECT_TRUE(denied.NamesSerial("0A"));
  EXPECT_FALSE(denied.NamesSerial("A"));
  EXPECT_TRUE(denied.NamesIssued("0A", "CN=north,O=a b"));
  EXPECT_FALSE(denied.NamesIssued("0A", "CN=south"));
}

TEST(DeniedCertificates, AnAuthoritysListNamesNothingOfItsNamesake) {
  const testing::TestAuthority authority;
  const testing::TestAuthority namesake;
  const Certificate own = CertificateOf(authority.Issue(testing::RobotSpec("rcan://a/1")));
  const Certificate signer = CertificateOf({authority.certificate(), ""});
  const Certificate other = CertificateOf({namesake.certificate(), ""});
  DeniedCertificates denied;
  denied.Add({.serial = ShownBy(*own).serial, .signer = KeyDigestOf(*signer)});
  EXPECT_EQ(denied.size(), 1U);
  EXPECT_TRUE(Denies(denied, NamedBy(*own, ChainOf({own.get(), signer.get()}).get())));
  EXPECT_FALSE(Denies(denied, NamedBy(*own, ChainOf({own.get(), other.get()}).get())));
  // The authority's own is ours.
  DeniedCertificates root;
  root.Add({.serial = ShownBy(*signer).serial, .signer = KeyDigestOf(*signer)});
  EXPECT_FALSE(Denies(root, NamedBy(*own, ChainOf({own.get(), signer.get()}).get())));
  // One that an operator trusts without another's word.
  EXPECT_TRUE(Denies(root, NamedBy(*signer, ChainOf({signer.get()}).get())));
  EXPECT_TRUE(Denies(root, NamedBy(*signer, nullptr)));
}

TEST(DeniedCertificates, AnAuthorityBetweenIsDeniedByTheListOfItsOwn) {
  const testing::TestAuthority root;
  const testing::TestAuthority between("between", root);
  const Certificate own = CertificateOf(between.Issue(testing::RobotSpec("rcan://a/1")));
  const Certificate signer = CertificateOf({between.certificate(), ""});
  const Certificate top = CertificateOf({root.certificate(), ""});
  const auto chain = ChainOf({own.get(), signer.get(), top.get()});
  DeniedCertificates denied;
  denied.Add({.serial = ShownBy(*signer).serial, .signer = KeyDigestOf(*top)});
  EXPECT_TRUE(Denies(denied, NamedBy(*own, chain.get())));
}

TEST(DeniedCertificates, WhatIsNoneOfItsKindNamesNothing) {
  DeniedCertificates denied;
  EXPECT_FALSE(denied.Add(RevokedBy::kIssuerSerial, "0A"));
  EXPECT_FALSE(denied.Add(RevokedBy::kIssuerSerial, " CN=a"));
  EXPECT_FALSE(denied.Add(RevokedBy::kKey, std::string(63, 'a')));
  EXPECT_FALSE(denied.Add(RevokedBy::kKey, std::string(64, 'A')));
  EXPECT_FALSE(denied.Add(RevokedBy::kCertificate, std::string(64, 'g')));
  EXPECT_EQ(denied.size(), 0U);
}

/// A renewed certificate must be no way back for a key that is revoked.
TEST(DeniedCertificates, AKeyHasOneDigestInEveryForm) {
  const testing::TestAuthority authority;
  for (const char* const kind : {"P-256", "P-384", "P-521"}) {
    testing::CertificateSpec spec = testing::RobotSpec("rcan://a/1");
    spec.key = kind;
    spec.compressed = true;
    const Certificate compressed = CertificateOf(authority.Issue(spec));
    // The same key as OpenSSL writes it by default.
    const Key key(X509_get_pubkey(compressed.get()));
    ASSERT_EQ(EVP_PKEY_set_utf8_string_param(key.get(), "point-format", "uncompressed"), 1);
    const Certificate usual(X509_dup(compressed.get()));
    ASSERT_EQ(X509_set_pubkey(usual.get(), key.get()), 1);
    const int size = i2d_X509_PUBKEY(X509_get_X509_PUBKEY(usual.get()), nullptr);
    ASSERT_GT(size, i2d_X509_PUBKEY(X509_get_X509_PUBKEY(compressed.get()), nullptr));
    EXPECT_EQ(ShownBy(*compressed).key_sha256, ShownBy(*usual).key_sha256) << kind;
    EXPECT_NE(ShownBy(*compressed).sha256, ShownCertificate::Sha256()) << kind;
  }
}

}  // namespace
}  // namespace uplink::identity
