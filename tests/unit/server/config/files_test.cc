#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/config/load.h"
#include "tests/support/certificates.h"

namespace uplink::config {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

class ValidateFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "uplinkd_files_XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    Use(testing::ServerSpec());
    config_.tls.client_ca_file = Write("ca.crt", "text\n" + authority_.certificate());
    config_.store.url = "sqlite://" + folder_ + "/uplinkd.db";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }

  /// The server's certificate and key.
  void Use(const testing::CertificateSpec& spec) {
    const testing::KeyPair pair = authority_.Issue(spec);
    config_.tls.certificate_file = Write("s.crt", pair.certificate);
    config_.tls.key_file = Write("s.key", pair.key);
  }

  const testing::TestAuthority authority_;
  std::string folder_;
  Config config_;
};

TEST_F(ValidateFilesTest, TakesFilesThatAreThere) {
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
}

TEST_F(ValidateFilesTest, ReportsEachFileThatIsNot) {
  config_.tls.certificate_file += ".gone";
  config_.tls.key_file += ".gone";
  config_.tls.client_ca_file += ".gone";
  config_.tls.operator_ca_file = folder_ + "/gone";
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(4));
  EXPECT_EQ(problems[0].key, "tls.certificate_file");
  EXPECT_THAT(problems[0].text, HasSubstr("No such file"));
}

TEST_F(ValidateFilesTest, RefusesAKeyThatIsNotTheCertificates) {
  Write("s.key", authority_.Issue(testing::ServerSpec()).key);
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].key, "tls.certificate_file");
  EXPECT_THAT(problems[0].text, HasSubstr("s.key: is not the key of"));
}

TEST_F(ValidateFilesTest, RefusesACertificateThatNoServerMayShow) {
  Use(testing::RobotSpec("rcan://a"));
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_THAT(problems[0].text, HasSubstr("serverAuth"));
}

TEST_F(ValidateFilesTest, SaysWhenTheCertificateHasExpired) {
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.not_after_s = 7200;
  Use(spec);
  const SystemTime now = SystemClock().System();
  EXPECT_THAT(ExpiredFiles(config_, now), IsEmpty());
  const std::vector<Note> notes = ExpiredFiles(config_, now + std::chrono::hours(5));
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0].text, HasSubstr("expired 3 h ago by this machine's clock; replace it"));
  EXPECT_THAT(ValidateFiles(config_), IsEmpty()) << "a server starts all the same";
}

TEST_F(ValidateFilesTest, ThePairOfHttpIsChecked) {
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.not_after_s = 60;
  const testing::KeyPair pair = authority_.Issue(spec);
  config_.http.tls_certificate_file = Write("h.crt", pair.certificate);
  config_.http.tls_key_file = Write("h.key", pair.key);
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
  const std::vector<Note> notes =
      ExpiredFiles(config_, SystemClock().System() + std::chrono::minutes(2));
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_EQ(notes[0].key, "http.tls.certificate_file");

  Write("h.key", authority_.Issue(testing::ServerSpec()).key);
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].key, "http.tls.certificate_file");
  EXPECT_THAT(problems[0].text, HasSubstr("h.key: is not the key of"));
}

TEST_F(ValidateFilesTest, TheFilesOfTokensAreChecked) {
  config_.http.tokens_file = Write("tokens", "# none yet\n");
  config_.http.metrics_token_file = Write("metrics", "0123456789abcdef\n");
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
  Write("tokens", "\nsecret\n");
  Write("metrics", "short\n");
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].key, "http.tokens_file");
  EXPECT_EQ(problems[0].text, "line 2: is no JSON object of a token");
  EXPECT_EQ(problems[1].key, "http.metrics_token_file");
  EXPECT_THAT(problems[1].text, StartsWith("its first line is no token"));
}

TEST_F(ValidateFilesTest, SaysWhenTheCertificateForABrokerHasExpired) {
  testing::CertificateSpec spec = testing::RobotSpec("rcan://a");
  spec.not_after_s = 60;
  config_.mqtt.client_certificate_file = Write("c.crt", authority_.Issue(spec).certificate);
  const SystemTime now = SystemClock().System();
  EXPECT_THAT(ExpiredFiles(config_, now), IsEmpty());
  const std::vector<Note> notes = ExpiredFiles(config_, now + std::chrono::minutes(2));
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_EQ(notes[0].key, "mqtt.client_certificate_file");
  EXPECT_THAT(notes[0].text, HasSubstr("expired 0 h ago"));
}

TEST_F(ValidateFilesTest, FilesAreLookedAtBesideBadValues) {
  const std::string text = "[tls]\ncertificate_file = \"" + folder_ + "/gone\"\nkey_file = \"" +
                           config_.tls.key_file + "\"\nclient_ca_file = \"" +
                           config_.tls.client_ca_file +
                           "\"\n[store]\nurl = \"nonsense\"\n[limits]\nrobots_max = 0\n";
  const LoadResult result = WithFiles(ParseConfig(text, "c", {}));
  EXPECT_FALSE(result.ok());
  std::vector<std::string> keys;
  for (const Problem& problem : result.problems) keys.push_back(problem.key);
  EXPECT_THAT(keys, ::testing::UnorderedElementsAre("tls.certificate_file", "store.url",
                                                    "limits.robots_max"));
  EXPECT_THAT(WithFiles(ParseConfig("[tls", "c", {})).problems, SizeIs(1));
}

TEST_F(ValidateFilesTest, ReadsEveryCertificateOfAnAuthorityFile) {
  const testing::TestAuthority other("other");
  const std::string good = authority_.certificate() + other.certificate();
  std::string broken = good;
  broken.replace(broken.rfind("\nMII"), 4, "\nXXX");
  config_.tls.client_ca_file = Write("ca.crt", good);
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
  config_.tls.client_ca_file = Write("ca.crt", broken);
  config_.tls.operator_ca_file = Write("operators.crt", broken);
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].key, "tls.client_ca_file");
  EXPECT_THAT(problems[0].text, StartsWith("PEM block 2"));
  EXPECT_EQ(problems[1].key, "tls.operator_ca_file");
  EXPECT_THAT(problems[1].text, StartsWith("PEM block 2"));
}

TEST_F(ValidateFilesTest, AListIsSignedByAnAuthorityOfItsOwnFile) {
  const testing::TestAuthority operators("operators");
  config_.tls.operator_ca_file = Write("operators.crt", operators.certificate());
  config_.tls.client_crl_file = Write("robots.crl", authority_.Revoke({}));
  config_.tls.operator_crl_file = Write("operators.crl", operators.Revoke({}));
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
  std::swap(config_.tls.client_crl_file, config_.tls.operator_crl_file);
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].key, "tls.client_crl_file");
  EXPECT_EQ(problems[1].key, "tls.operator_crl_file");
  // Without a file of their own, operators' authorities are the robots'.
  config_.tls.operator_ca_file.clear();
  config_.tls.operator_crl_file = Write("operators.crl", authority_.Revoke({}));
  config_.tls.client_crl_file.clear();
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
}

TEST_F(ValidateFilesTest, AListWithoutAFileOfAuthoritiesIsAProblem) {
  config_.tls.client_crl_file = Write("robots.crl", authority_.Revoke({}));
  config_.tls.client_ca_file.clear();
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].key, "tls.client_crl_file");
  EXPECT_THAT(problems[0].text, HasSubstr("needs tls.client_ca_file"));
}

TEST_F(ValidateFilesTest, KnowsACertificateFromAKey) {
  std::swap(config_.tls.certificate_file, config_.tls.key_file);
  EXPECT_THAT(ValidateFiles(config_), SizeIs(2));
}

TEST_F(ValidateFilesTest, ACertificateAndItsKeyMayShareAFile) {
  const testing::KeyPair pair = authority_.Issue(testing::ServerSpec());
  config_.tls.certificate_file = Write("both.pem", pair.certificate + pair.key);
  config_.tls.key_file = config_.tls.certificate_file;
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());
}

TEST_F(ValidateFilesTest, RefusesAnEmptyFileAndAFolder) {
  config_.tls.certificate_file = Write("empty", "");
  config_.tls.key_file = folder_;
  EXPECT_THAT(ValidateFiles(config_), SizeIs(2));
}

TEST_F(ValidateFilesTest, RequiresTheFolderOfTheStore) {
  config_.store.url = "sqlite://" + folder_ + "/gone/uplinkd.db";
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_THAT(problems[0].text, HasSubstr("/gone does not exist; make it"));
}

TEST_F(ValidateFilesTest, LooksAtTheFilesForABroker) {
  testing::CertificateSpec spec;
  spec.common_names = {"uplinkd"};
  const testing::KeyPair pair = authority_.Issue(spec);
  config_.mqtt.url = "mqtts://broker";
  config_.mqtt.ca_file = config_.tls.client_ca_file;
  config_.mqtt.client_certificate_file = Write("c.crt", pair.certificate);
  config_.mqtt.client_key_file = Write("c.key", pair.key);
  config_.mqtt.password_file = Write("password", std::string(4095, 'p') + "\n");
  EXPECT_THAT(ValidateFiles(config_), IsEmpty());

  Write("c.key", authority_.Issue(spec).key);
  std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].key, "mqtt.client_certificate_file");
  EXPECT_THAT(problems[0].text, HasSubstr("c.key: is not the key of"));

  config_.mqtt.ca_file = folder_ + "/gone";
  config_.mqtt.client_certificate_file = folder_ + "/gone";
  config_.mqtt.client_key_file = folder_ + "/gone";
  config_.mqtt.password_file = folder_ + "/gone";
  problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(4));
  EXPECT_EQ(problems[0].key, "mqtt.ca_file");
  EXPECT_EQ(problems[1].key, "mqtt.client_certificate_file");
  EXPECT_EQ(problems[2].key, "mqtt.client_key_file");
  EXPECT_EQ(problems[3].key, "mqtt.password_file");

  config_.mqtt.url.clear();
  EXPECT_THAT(ValidateFiles(config_), IsEmpty()) << "what is not used is not looked at";
}

TEST_F(ValidateFilesTest, ABrokersPasswordIsSomeBytes) {
  config_.mqtt.url = "mqtts://broker";
  for (const std::string& text : {std::string(), std::string("\r\n"), std::string(4097, 'p')}) {
    config_.mqtt.password_file = Write("password", text);
    EXPECT_THAT(ValidateFiles(config_), SizeIs(1)) << text.size();
  }
}

TEST_F(ValidateFilesTest, DoesNotWaitForAPipeWithAPassword) {
  config_.mqtt.url = "mqtts://broker";
  config_.mqtt.password_file = folder_ + "/pipe";
  ASSERT_EQ(mkfifo(config_.mqtt.password_file.c_str(), 0600), 0);
  const std::vector<Problem> problems = ValidateFiles(config_);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_THAT(problems[0].text, HasSubstr("is not a regular file"));
}

TEST_F(ValidateFilesTest, RefusesAFolderAsTheStore) {
  config_.store.url = "sqlite://" + folder_;
  EXPECT_THAT(ValidateFiles(config_), SizeIs(1));
}

}  // namespace
}  // namespace uplink::config
