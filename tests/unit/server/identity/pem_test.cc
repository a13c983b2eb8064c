// How PEM texts are read, and a context of TLS is made of them.
#include "server/identity/pem.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "tests/support/certificates.h"
#include "tests/support/openssl_owners.h"
#include "tests/support/pem_texts.h"

namespace uplink::identity {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class PemTest : public ::testing::Test {
 protected:
  ~PemTest() override { ERR_clear_error(); }

  /// What is said of the text; empty if it is good.
  static std::string SaidOfKey(const std::string& text) {
    return std::string(ReadKey({"a.pem", text}).status().message());
  }
  static std::string SaidOfCertificates(const std::string& text) {
    return std::string(ReadCertificates({"a.pem", text}).status().message());
  }

  testing::TestAuthority root_{"root"};
  testing::TestAuthority issuer_{"issuer", root_};
  testing::KeyPair pair_ = issuer_.Issue(testing::ServerSpec());
  testing::SslContext context_{SSL_CTX_new(TLS_method())};
};

TEST_F(PemTest, AChainIsTheOwnCertificateAndThoseBehindIt) {
  EXPECT_TRUE(UseChain(context_.get(), pair_.certificate + issuer_.certificate()));
  STACK_OF(X509)* chain = nullptr;
  ASSERT_EQ(SSL_CTX_get0_chain_certs(context_.get(), &chain), 1);
  EXPECT_EQ(sk_X509_num(chain), 1);
  const auto own = ReadCertificates({"", pair_.certificate});
  ASSERT_TRUE(own.ok()) << own.status();
  EXPECT_EQ(X509_cmp(SSL_CTX_get0_certificate(context_.get()), own->front().get()), 0);
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

TEST_F(PemTest, AKeyBehindItsParametersIsRead) {
  const std::string text = testing::EcparamKey(pair_.key);
  ASSERT_THAT(text, HasSubstr("BEGIN EC PARAMETERS"));
  EXPECT_EQ(SaidOfKey(text), "");
  EXPECT_EQ(SaidOfKey(testing::WithCrlf(text)), "");
  ASSERT_TRUE(UseChain(context_.get(), pair_.certificate));
  EXPECT_TRUE(UseKey(context_.get(), text));
}

TEST_F(PemTest, AKeyMayStandBesideCertificatesBeforeAndBehindIt) {
  EXPECT_EQ(SaidOfKey(pair_.certificate + pair_.key), "");
  EXPECT_EQ(SaidOfKey("notes\n" + pair_.key + root_.certificate() + "notes"), "");
  EXPECT_EQ(SaidOfCertificates(pair_.key + pair_.certificate), "");
  EXPECT_EQ(SaidOfCertificates(testing::LockedKey(pair_.key) + pair_.certificate), "");
}

TEST_F(PemTest, AKeyBehindAPassPhraseIsNamedWithoutAskingForIt) {
  for (const std::string& locked :
       {testing::LockedKey(pair_.key), testing::LockedOwnKey(pair_.key)}) {
    ASSERT_THAT(locked, HasSubstr("ENCRYPTED"));
    EXPECT_THAT(
        SaidOfKey(testing::BlockOf("EC PARAMETERS") + locked),
        HasSubstr("a.pem: PEM block 2, from line 3, is a private key behind a pass phrase"));
    EXPECT_FALSE(UseKey(context_.get(), locked));
    EXPECT_THAT(SaidOfKey(pair_.key + locked), HasSubstr("block 2"));
  }
}

TEST_F(PemTest, ASecondKeyIsNamed) {
  EXPECT_THAT(SaidOfKey(pair_.certificate + pair_.key + root_.certificate() + pair_.key),
              AllOf(HasSubstr("a.pem: PEM block 4"),
                    HasSubstr("is a second private key: block 2 is one already")));
}

TEST_F(PemTest, ATextWithoutAKeyAndABrokenKeyAreNamed) {
  EXPECT_EQ(SaidOfKey(""), "a.pem: holds no PEM private key; name the file that does");
  EXPECT_EQ(SaidOfKey(pair_.certificate),
            "a.pem: holds no PEM private key; name the file that does");
  EXPECT_EQ(SaidOfKey(testing::BlockOf("EC PARAMETERS")),
            "a.pem: holds no PEM private key; name the file that does");
  EXPECT_THAT(SaidOfKey(testing::BlockOf("EC PARAMETERS") + testing::BlockOf("PRIVATE KEY")),
              HasSubstr("a.pem: PEM block 2, from line 3, is broken"));
  EXPECT_THAT(SaidOfKey(testing::BlockOf("PRIVATE KEY", "AAAA\n")), HasSubstr("is broken"));
}

TEST_F(PemTest, CertificatesAreReadOneAfterTheOther) {
  const std::string text = "notes\n" + pair_.certificate + "more\n" + root_.certificate();
  for (const std::string& each : {text, testing::WithCrlf(text)}) {
    const auto read = ReadCertificates({"a.pem", each});
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_THAT(*read, SizeIs(2));
  }
}

TEST_F(PemTest, ABrokenCertificateBehindAGoodOneIsNamed) {
  const std::string broken = testing::With(issuer_.certificate(), "\nMII", "\nXXX");
  EXPECT_THAT(SaidOfCertificates(pair_.certificate + broken + root_.certificate()),
              AllOf(HasSubstr("a.pem: PEM block 2"),
                    HasSubstr("is broken: it is no certificate that can be read")));
  EXPECT_FALSE(UseChain(context_.get(), pair_.certificate + broken));
}

TEST_F(PemTest, NoErrorOfOpensslIsLeftBehind) {
  EXPECT_NE(SaidOfKey(testing::LockedOwnKey(pair_.key)), "");
  EXPECT_NE(SaidOfKey(testing::BlockOf("PRIVATE KEY", "AAAA\n")), "");
  EXPECT_NE(SaidOfCertificates(testing::BlockOf("CERTIFICATE", "AAAA\n")), "");
  EXPECT_EQ(SaidOfCertificates(pair_.certificate), "");
  EXPECT_EQ(ERR_peek_error(), 0U);
}

}  // namespace
}  // namespace uplink::identity
