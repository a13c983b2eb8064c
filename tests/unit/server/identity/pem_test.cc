// How a context of TLS is made of PEM texts.
#include "server/identity/pem.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>

#include "tests/support/certificates.h"
#include "tests/support/openssl_owners.h"

namespace uplink::identity {
namespace {

class PemTest : public ::testing::Test {
 protected:
  ~PemTest() override { ERR_clear_error(); }

  testing::TestAuthority root_{"root"};
  testing::TestAuthority issuer_{"issuer", root_};
  testing::KeyPair pair_ = issuer_.Issue(testing::ServerSpec());
  testing::SslContext context_{SSL_CTX_new(TLS_method())};
};

/// The same key behind a pass phrase.
std::string Locked(const std::string& key_pem) {
  const Key key = ReadKey(key_pem);
  const Bio out(BIO_new(BIO_s_mem()));
  unsigned char phrase[] = "phrase";
  EXPECT_EQ(PEM_write_bio_PKCS8PrivateKey(out.get(), key.get(), EVP_aes_128_cbc(),
                                          reinterpret_cast<char*>(phrase), sizeof(phrase) - 1,
                                          nullptr, nullptr),
            1);
  char* text = nullptr;
  const long bytes = BIO_get_mem_data(out.get(), &text);
  return {text, static_cast<std::size_t>(bytes)};
}

TEST_F(PemTest, AChainIsTheOwnCertificateAndThoseBehindIt) {
  EXPECT_TRUE(UseChain(context_.get(), pair_.certificate + issuer_.certificate()));
  STACK_OF(X509)* chain = nullptr;
  ASSERT_EQ(SSL_CTX_get0_chain_certs(context_.get(), &chain), 1);
  EXPECT_EQ(sk_X509_num(chain), 1);
  const Certificate own = NextCertificate(PemReader(pair_.certificate).get());
  EXPECT_EQ(X509_cmp(SSL_CTX_get0_certificate(context_.get()), own.get()), 0);
}

TEST_F(PemTest, ATextWithoutACertificateIsNoChain) {
  EXPECT_FALSE(UseChain(context_.get(), ""));
  EXPECT_FALSE(UseChain(context_.get(), pair_.key));
}

TEST_F(PemTest, AKeyIsThatOfTheCertificate) {
  ASSERT_TRUE(UseChain(context_.get(), pair_.certificate));
  EXPECT_TRUE(UseKey(context_.get(), pair_.key));
  EXPECT_FALSE(UseKey(context_.get(), issuer_.Issue(testing::ServerSpec()).key));
  EXPECT_FALSE(UseKey(context_.get(), pair_.certificate));
}

TEST_F(PemTest, AKeyBehindAPassPhraseIsNotRead) {
  const std::string locked = Locked(pair_.key);
  ASSERT_NE(locked.find("ENCRYPTED"), std::string::npos);
  EXPECT_EQ(ReadKey(locked), nullptr);
  EXPECT_FALSE(UseKey(context_.get(), locked));
}

TEST_F(PemTest, CertificatesAreReadOneAfterTheOther) {
  const std::string text = "notes\n" + pair_.certificate + "more\n" + root_.certificate();
  const Bio reader = PemReader(text);
  EXPECT_NE(NextCertificate(reader.get()), nullptr);
  EXPECT_NE(NextCertificate(reader.get()), nullptr);
  EXPECT_EQ(NextCertificate(reader.get()), nullptr);
}

}  // namespace
}  // namespace uplink::identity
