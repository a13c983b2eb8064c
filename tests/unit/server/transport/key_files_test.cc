// What a start takes and refuses, a reload takes and refuses, too.
#include "server/transport/key_files.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/load.h"
#include "server/identity/pem.h"
#include "tests/support/certificates.h"
#include "tests/support/pem_texts.h"
#include "tests/support/temp_folder.h"

namespace uplink::transport {
namespace {

using testing::BlockOf;
using ::testing::HasSubstr;
using testing::With;

class KeyFilesTest : public ::testing::Test {
 protected:
  KeyFilesTest() {
    config_.tls.certificate_file = folder_.File("server.crt");
    config_.tls.key_file = folder_.File("server.key");
    config_.tls.client_ca_file = folder_.File("ca.crt");
    config_.store.url = "sqlite://" + folder_.File("uplinkd.db");
  }

  void Write(const PemTexts& texts) const {
    std::ofstream(config_.tls.certificate_file) << texts.certificate;
    std::ofstream(config_.tls.key_file) << texts.key;
    std::ofstream(config_.tls.client_ca_file) << texts.client_ca;
  }

  /// What a start says of the files; empty if it takes them.
  [[nodiscard]] std::string SaidAtAStart() const {
    const auto problems = config::ValidateFiles(config_);
    return problems.empty() ? std::string() : problems.front().where + ": " + problems.front().text;
  }

  /// What a server that runs says of these after good ones; empty if it serves with them.
  [[nodiscard]] std::string SaidAtARenewal(const PemTexts& texts) const {
    KeyFiles files(
        {config_.tls.certificate_file, config_.tls.key_file, config_.tls.client_ca_file});
    Write(good_);
    EXPECT_TRUE(files.Refresh().value_or(false));
    Write(texts);
    const auto taken = files.Refresh();
    EXPECT_EQ(files.texts().key == texts.key && files.texts().certificate == texts.certificate &&
                  files.texts().client_ca == texts.client_ca,
              taken.ok())
        << "the last good ones are served";
    return std::string(taken.status().message());
  }

  void ExpectTaken(const PemTexts& texts, const std::string& what) const {
    EXPECT_EQ(SaidAtARenewal(texts), "") << what;
    EXPECT_EQ(SaidAtAStart(), "") << what;
  }
  void ExpectRefused(const PemTexts& texts, const std::string& says) const {
    EXPECT_THAT(SaidAtARenewal(texts), HasSubstr(says));
    EXPECT_THAT(SaidAtAStart(), HasSubstr(says));
  }

  [[nodiscard]] PemTexts WithKey(const std::string& key) const {
    return {renewed_.certificate, key, authority_.certificate()};
  }
  [[nodiscard]] PemTexts WithChain(const std::string& behind) const {
    return {renewed_.certificate + behind, renewed_.key, authority_.certificate()};
  }
  [[nodiscard]] PemTexts WithAuthority(const std::string& authority) const {
    return {renewed_.certificate, renewed_.key, authority};
  }

  const testing::TempFolder folder_;
  config::Config config_;
  const testing::TestAuthority authority_;
  const testing::TestAuthority other_{"other"};
  const testing::KeyPair first_ = authority_.Issue(testing::ServerSpec());
  const testing::KeyPair renewed_ = authority_.Issue(testing::ServerSpec());
  const PemTexts good_{first_.certificate, first_.key, authority_.certificate()};
};

TEST_F(KeyFilesTest, BothTakeAKeyAsAnyToolWritesIt) {
  ExpectTaken(WithKey(testing::EcparamKey(renewed_.key)), "parameters first");
  ExpectTaken(WithKey(testing::WithCrlf(testing::EcparamKey(renewed_.key))), "as on Windows");
  ExpectTaken(WithKey("Bag Attributes\n  localKeyID: 01\n" + renewed_.key), "text before it");
  ExpectTaken(WithKey(renewed_.certificate + renewed_.key), "beside its certificate");
  ExpectTaken(WithKey(renewed_.key + "text behind it"), "text behind it");
  ExpectTaken(WithKey("\xEF\xBB\xBF" + renewed_.key), "a byte order mark");
}

TEST_F(KeyFilesTest, AnEntryCountsForAnAuthorityThatStandsElsewhereToo) {
  const std::string folder = folder_.File("authorities");
  ASSERT_TRUE(std::filesystem::create_directory(folder));
  std::ofstream(folder + "/hall.pem") << authority_.certificate();
  std::ofstream(folder + "/hall.toml") << "roles = [\"viewer\"]\n";
  std::ofstream(folder + "/guests.pem") << other_.certificate();
  std::ofstream(folder + "/guests.toml") << "";
  KeyFiles files({.certificate = config_.tls.certificate_file,
                  .key = config_.tls.key_file,
                  .client_ca = config_.tls.client_ca_file,
                  .authorities = folder,
                  .entries_alone = true});
  Write(good_);
  ASSERT_TRUE(files.Refresh().value_or(false));
  EXPECT_EQ(files.texts().client_ca, good_.client_ca) << "the folder adds none";
  const auto hall = identity::ReadCertificates({"hall", authority_.certificate()});
  ASSERT_TRUE(hall.ok()) << hall.status();
  EXPECT_FALSE(files.texts()
                   .rules.Judge({.role = identity::Role::kAdmin, .fleet = "*"}, *hall->front())
                   .ok());
}

TEST_F(KeyFilesTest, BothTakeAChainBesideItsKey) {
  ExpectTaken(WithChain(other_.certificate()), "a chain");
  ExpectTaken(WithChain("text\n" + BlockOf("DH PARAMETERS") + renewed_.key), "other blocks");
}

TEST_F(KeyFilesTest, BothRefuseAKeyThatCannotBeRead) {
  ExpectRefused(WithKey(testing::LockedKey(renewed_.key)),
                "server.key: PEM block 1, from line 1, ");
  ExpectRefused(WithKey(testing::LockedOwnKey(renewed_.key)), "behind a pass phrase");
  ExpectRefused(WithKey(renewed_.key + first_.key), "server.key: PEM block 2, from line 6, is a");
  ExpectRefused(WithKey(BlockOf("EC PARAMETERS")), "server.key: holds no PEM private key");
  ExpectRefused(WithKey(BlockOf("OPENSSH PRIVATE KEY")), "holds no OPENSSH PRIVATE KEY");
  ExpectRefused(WithKey(With(renewed_.key, "\nM", "\nX")), "server.key: PEM block 1");
  ExpectRefused(WithKey(first_.key), "server.key: is not the key of ");
  ExpectRefused(WithKey(std::string(identity::kPemBytesMax + 1, ' ')), "is larger than");
}

TEST_F(KeyFilesTest, BothRefuseAChainWithABrokenCertificate) {
  const std::string broken = With(other_.certificate(), "\nMII", "\nXXX");
  ExpectRefused(WithChain(broken), "server.crt: PEM block 2, from line ");
  ExpectRefused(WithChain(With(other_.certificate(), "-----BEGIN", "----BEGIN")),
                "server.crt: PEM block 2, from line ");
  ExpectRefused(WithChain(BlockOf("PKCS7")), "holds no PKCS7");
}

TEST_F(KeyFilesTest, BothRefuseAnAuthorityThatCannotBeRead) {
  const std::string good = authority_.certificate();
  ExpectTaken(WithAuthority(good + other_.certificate()), "two");
  ExpectRefused(WithAuthority(good + With(other_.certificate(), "\nMII", "\nXXX")),
                "ca.crt: PEM block 2, from line ");
  ExpectRefused(WithAuthority(good + BlockOf("X509 CRL")),
                "cannot be used: lists of revoked certificates are not read");
}

}  // namespace
}  // namespace uplink::transport
