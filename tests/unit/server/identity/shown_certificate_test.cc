#include "server/identity/shown_certificate.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

#include "server/identity/expiry.h"
#include "server/identity/pem.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

/// SHA-256 as hexadecimal text, computed by another way than the code under test.
std::string Digest(const unsigned char* bytes, int size) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(bytes, static_cast<std::size_t>(size), digest.data());
  std::string text;
  for (const unsigned char byte : digest) {
    constexpr std::string_view kHex = "0123456789abcdef";
    text += {kHex[byte / 16], kHex[byte % 16]};
  }
  return text;
}

class ShownCertificateTest : public ::testing::Test {
 protected:
  ShownCertificateTest() {
    auto read = ReadCertificates({"a.crt", keys_.certificate});
    EXPECT_TRUE(read.ok()) << read.status();
    if (read.ok()) certificate_ = std::move(read->front());
  }

  const testing::TestAuthority authority_;
  const testing::KeyPair keys_ = authority_.Issue(testing::RobotSpec("rcan://a/1"));
  Certificate certificate_;
};

TEST_F(ShownCertificateTest, TheDigestsAreThoseOfItsDer) {
  const storage::CertificateFacts facts = FactsOf(ShownBy(*certificate_));
  unsigned char* der = nullptr;
  const int size = i2d_X509(certificate_.get(), &der);
  EXPECT_EQ(facts.sha256, Digest(der, size));
  OPENSSL_free(der);
  der = nullptr;
  const int key_size = i2d_PUBKEY(X509_get0_pubkey(certificate_.get()), &der);
  EXPECT_EQ(facts.key_sha256, Digest(der, key_size));
  OPENSSL_free(der);
}

TEST_F(ShownCertificateTest, TheIssuerIsWrittenAsOpensslWritesIt) {
  EXPECT_EQ(IssuerOf(*certificate_), "CN=test authority");
}

TEST_F(ShownCertificateTest, TheSerialIsWrittenAsOpensslWritesIt) {
  const storage::CertificateFacts facts = FactsOf(ShownBy(*certificate_));
  ASN1_INTEGER* serial = X509_get_serialNumber(certificate_.get());
  const Bio text(BIO_new(BIO_s_mem()));
  ASSERT_GT(i2a_ASN1_INTEGER(text.get(), serial), 0);
  char* begin = nullptr;
  const long size = BIO_get_mem_data(text.get(), &begin);
  EXPECT_EQ(facts.serial, std::string(begin, static_cast<std::size_t>(size)));
}

TEST_F(ShownCertificateTest, ItEndsWhenItSays) {
  const storage::CertificateFacts facts = FactsOf(ShownBy(*certificate_));
  EXPECT_EQ(facts.not_after, ExpiryOf({"a.crt", keys_.certificate}).value());
}

TEST(ShownCertificate, NoneIsNone) {
  const storage::CertificateFacts facts = FactsOf({});
  EXPECT_TRUE(facts.serial.empty());
  EXPECT_TRUE(facts.sha256.empty());
  EXPECT_FALSE(facts.not_after.has_value());
}

}  // namespace
}  // namespace uplink::identity
