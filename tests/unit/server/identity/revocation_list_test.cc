#include "server/identity/revocation_list.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RevocationListTest : public ::testing::Test {
 protected:
  [[nodiscard]] absl::StatusOr<std::vector<RevocationList>> Read(const std::string& text) const {
    return ReadRevocationLists({"a.crl", text}, {"ca.crt", authority_.certificate()});
  }
  static ShownCertificate ShownOf(const std::string& pem) {
    const auto read = ReadCertificates({"a.crt", pem});
    EXPECT_TRUE(read.ok()) << read.status();
    return ShownBy(*read->front());
  }
  static SignedSerial Named(const testing::KeyPair& keys, const testing::TestAuthority& signer) {
    return {ShownOf(keys.certificate).serial, ShownOf(signer.certificate()).key_sha256};
  }

  const testing::TestAuthority authority_;
  const testing::KeyPair keys_ = authority_.Issue(testing::RobotSpec("rcan://a/1"));
};

TEST_F(RevocationListTest, NamesWhatAListOfRevocationsNames) {
  const auto lists = Read(authority_.Revoke({keys_}));
  ASSERT_TRUE(lists.ok()) << lists.status();
  ASSERT_THAT(*lists, SizeIs(1));
  EXPECT_EQ(lists->front().issuer, "CN=test authority");
  EXPECT_THAT(lists->front().revoked, ElementsAre(Named(keys_, authority_)));
  EXPECT_TRUE(lists->front().next_update.has_value());
}

TEST_F(RevocationListTest, AnEmptyListIsGood) {
  const auto lists = Read(authority_.Revoke({}));
  ASSERT_TRUE(lists.ok()) << lists.status();
  EXPECT_THAT(lists->front().revoked, IsEmpty());
}

TEST_F(RevocationListTest, AListThatIsOverCounts) {
  const auto lists = Read(authority_.Revoke({keys_}, -60));
  ASSERT_TRUE(lists.ok()) << lists.status();
  EXPECT_THAT(lists->front().revoked, SizeIs(1));
}

TEST_F(RevocationListTest, DerIsReadToo) {
  const std::string pem = authority_.Revoke({keys_});
  const Bio bio = PemReader(pem);
  X509_CRL* const list = PEM_read_bio_X509_CRL(bio.get(), nullptr, nullptr, nullptr);
  ASSERT_NE(list, nullptr);
  unsigned char* bytes = nullptr;
  const int size = i2d_X509_CRL(list, &bytes);
  const std::string der(bytes, bytes + size);
  OPENSSL_free(bytes);
  X509_CRL_free(list);
  const auto lists = Read(der);
  ASSERT_TRUE(lists.ok()) << lists.status();
  EXPECT_THAT(lists->front().revoked, SizeIs(1));
  EXPECT_FALSE(Read(der + "x").ok());
  EXPECT_FALSE(Read(der.substr(0, der.size() - 1)).ok());
}

TEST_F(RevocationListTest, SeveralListsOfAFileCount) {
  const testing::TestAuthority other("other authority");
  const auto lists =
      ReadRevocationLists({"a.crl", authority_.Revoke({keys_}) + other.Revoke({})},
                          {"ca.crt", authority_.certificate() + other.certificate()});
  ASSERT_TRUE(lists.ok()) << lists.status();
  EXPECT_THAT(*lists, SizeIs(2));
}

TEST_F(RevocationListTest, AListIsOfTheNamesakeThatSignedIt) {
  const testing::TestAuthority namesake;
  const auto lists =
      ReadRevocationLists({"a.crl", namesake.Revoke({keys_})},
                          {"ca.crt", authority_.certificate() + namesake.certificate()});
  ASSERT_TRUE(lists.ok()) << lists.status();
  EXPECT_THAT(lists->front().revoked, ElementsAre(Named(keys_, namesake)));
}

TEST_F(RevocationListTest, AListOfAnotherAuthorityIsNone) {
  const testing::TestAuthority other("other authority");
  EXPECT_THAT(std::string(Read(other.Revoke({keys_})).status().message()),
              HasSubstr("a.crl: the list of CN=other authority is not signed by an authority of "
                        "ca.crt"));
  // The same name, and another key.
  const testing::TestAuthority impostor;
  EXPECT_FALSE(Read(impostor.Revoke({keys_})).ok());
}

TEST_F(RevocationListTest, WhatIsNoListIsSaid) {
  EXPECT_THAT(std::string(Read("").status().message()), HasSubstr("neither"));
  EXPECT_THAT(std::string(Read(authority_.certificate()).status().message()),
              HasSubstr("holds no PEM X509 CRL"));
  std::string broken = authority_.Revoke({keys_});
  broken.replace(broken.find('\n') + 1, 4, "!!!!");
  EXPECT_THAT(std::string(Read(broken).status().message()), HasSubstr("list 1 is broken"));
  EXPECT_FALSE(Read(authority_.Revoke({}) + broken).ok());
}

}  // namespace
}  // namespace uplink::identity
