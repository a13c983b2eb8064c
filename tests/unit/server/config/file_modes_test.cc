#include "server/config/file_modes.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temp_folder.h"
#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FileModesTest : public ::testing::Test {
 protected:
  FileModesTest() {
    config_.tls.key_file = Make("s.key");
    config_.store.url = "postgresql://u@db.example.org/d";
    config_.store.password_file = Make("password");
  }
  [[nodiscard]] std::string Make(const std::string& name) const {
    std::ofstream(folder_.File(name)) << "secret";
    Change(folder_.File(name), 0600);
    return folder_.File(name);
  }
  static void Change(const std::string& path, mode_t mode) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
  }
  [[nodiscard]] FileModes Check() const { return CheckFileModes(config_); }

  uplink::testing::TempFolder folder_;
  Config config_;
};

TEST_F(FileModesTest, WhatTheOwnerAndTheGroupMayReadIsGood) {
  for (const mode_t mode : {0400U, 0600U, 0440U, 0640U, 0700U}) {
    Change(config_.tls.key_file, mode);
    Change(config_.store.password_file, mode);
    EXPECT_THAT(Check().problems, IsEmpty()) << mode;
    EXPECT_THAT(Check().notes, IsEmpty()) << mode;
  }
}

// As a secret of Kubernetes is by default.
TEST_F(FileModesTest, WhatEverybodyMayReadIsNoted) {
  Change(config_.tls.key_file, 0644);
  Change(config_.store.password_file, 0444);
  const FileModes modes = Check();
  EXPECT_THAT(modes.problems, IsEmpty());
  EXPECT_THAT(modes.notes,
              ElementsAre(AllOf(Field(&Problem::key, "tls.key_file"),
                                Field(&Problem::text,
                                      AllOf(HasSubstr(config_.tls.key_file), HasSubstr("0644"))),
                                Field(&Note::event, "secret_readable")),
                          AllOf(Field(&Problem::key, "store.password_file"),
                                Field(&Problem::text, HasSubstr("0444")))));
}

TEST_F(FileModesTest, WhatTheGroupMayWriteIsNoted) {
  Change(config_.tls.key_file, 0660);
  const FileModes modes = Check();
  EXPECT_THAT(modes.problems, IsEmpty());
  EXPECT_THAT(modes.notes, ElementsAre(AllOf(Field(&Problem::key, "tls.key_file"),
                                             Field(&Note::event, "secret_writable"))));
}

TEST_F(FileModesTest, WhatEverybodyMayWriteIsAProblem) {
  Change(config_.tls.key_file, 0666);
  Change(config_.store.password_file, 0602);
  const FileModes modes = Check();
  EXPECT_THAT(modes.notes, IsEmpty());
  EXPECT_THAT(modes.problems,
              ElementsAre(AllOf(Field(&Problem::key, "tls.key_file"),
                                Field(&Problem::text,
                                      AllOf(HasSubstr(config_.tls.key_file), HasSubstr("0666")))),
                          AllOf(Field(&Problem::key, "store.password_file"),
                                Field(&Problem::text, HasSubstr("0602")))));
}

// A user who may write an authority lets robots in; one who may only read it learns nothing.
TEST_F(FileModesTest, CertificatesThatEverybodyMayWriteAreAProblem) {
  config_.tls.certificate_file = Make("s.crt");
  config_.tls.client_ca_file = Make("ca.crt");
  config_.tls.operator_ca_file = Make("op.crt");
  for (const mode_t mode : {0600U, 0644U, 0664U}) {
    Change(config_.tls.certificate_file, mode);
    Change(config_.tls.client_ca_file, mode);
    Change(config_.tls.operator_ca_file, mode);
    EXPECT_THAT(Check().problems, IsEmpty()) << mode;
    EXPECT_THAT(Check().notes, IsEmpty()) << mode;
  }
  Change(config_.tls.certificate_file, 0666);
  Change(config_.tls.client_ca_file, 0646);
  Change(config_.tls.operator_ca_file, 0602);
  EXPECT_THAT(
      Check().problems,
      ElementsAre(AllOf(Field(&Problem::key, "tls.certificate_file"),
                        Field(&Problem::text, HasSubstr("0666"))),
                  AllOf(Field(&Problem::key, "tls.client_ca_file"),
                        Field(&Problem::text, AllOf(HasSubstr(config_.tls.client_ca_file),
                                                    HasSubstr("0646"), HasSubstr("chmod o-w")))),
                  Field(&Problem::key, "tls.operator_ca_file")));
}

TEST_F(FileModesTest, ListsThatEverybodyMayWriteAreAProblem) {
  config_.tls.client_crl_file = Make("robots.crl");
  config_.tls.operator_crl_file = Make("operators.crl");
  Change(config_.tls.client_crl_file, 0644);
  Change(config_.tls.operator_crl_file, 0644);
  EXPECT_THAT(Check().problems, IsEmpty());
  Change(config_.tls.client_crl_file, 0646);
  Change(config_.tls.operator_crl_file, 0646);
  EXPECT_THAT(Check().problems, ElementsAre(Field(&Problem::key, "tls.client_crl_file"),
                                            Field(&Problem::key, "tls.operator_crl_file")));
}

TEST_F(FileModesTest, TheFilesForABrokerAreJudgedWhereThereIsOne) {
  config_.mqtt.ca_file = Make("broker_ca.crt");
  config_.mqtt.client_certificate_file = Make("c.crt");
  config_.mqtt.password_file = Make("broker_password");
  config_.mqtt.client_key_file = Make("c.key");
  for (const char* name : {"broker_ca.crt", "c.crt", "broker_password", "c.key"}) {
    Change(folder_.File(name), 0666);
  }
  EXPECT_THAT(Check().problems, IsEmpty()) << "there is no broker";
  config_.mqtt.url = "mqtts://broker";
  EXPECT_THAT(Check().problems, ElementsAre(Field(&Problem::key, "mqtt.ca_file"),
                                            Field(&Problem::key, "mqtt.client_certificate_file"),
                                            Field(&Problem::key, "mqtt.password_file"),
                                            Field(&Problem::key, "mqtt.client_key_file")));
  for (const char* name : {"broker_ca.crt", "c.crt", "broker_password", "c.key"}) {
    Change(folder_.File(name), 0644);
  }
  EXPECT_THAT(Check().problems, IsEmpty());
  EXPECT_THAT(Check().notes, ElementsAre(Field(&Problem::key, "mqtt.password_file"),
                                         Field(&Problem::key, "mqtt.client_key_file")));
}

TEST_F(FileModesTest, TheFilesOfHttpAreJudged) {
  config_.http.tls_certificate_file = Make("h.crt");
  config_.http.tls_key_file = Make("h.key");
  config_.http.tokens_file = Make("tokens");
  config_.http.metrics_token_file = Make("metrics_token");
  for (const char* name : {"h.crt", "h.key", "tokens", "metrics_token"}) {
    Change(folder_.File(name), 0666);
  }
  EXPECT_THAT(Check().problems, ElementsAre(Field(&Problem::key, "http.tls.certificate_file"),
                                            Field(&Problem::key, "http.tls.key_file"),
                                            Field(&Problem::key, "http.tokens_file"),
                                            Field(&Problem::key, "http.metrics_token_file")));
  for (const char* name : {"h.crt", "h.key", "tokens", "metrics_token"}) {
    Change(folder_.File(name), 0644);
  }
  EXPECT_THAT(Check().problems, IsEmpty());
  EXPECT_THAT(Check().notes, ElementsAre(Field(&Problem::key, "http.tls.key_file"),
                                         Field(&Problem::key, "http.tokens_file"),
                                         Field(&Problem::key, "http.metrics_token_file")));
}

TEST_F(FileModesTest, AConfigurationThatEverybodyMayWriteIsAProblem) {
  const std::string path = Make("u.toml");
  std::ofstream(path) << testing::kMinimal;
  Change(path, 0664);
  EXPECT_TRUE(LoadConfig(path, {}).ok());
  Change(path, 0666);
  const LoadResult result = LoadConfig(path, {});
  EXPECT_FALSE(result.ok());
  EXPECT_THAT(result.problems, ElementsAre(Field(&Problem::text, HasSubstr("may write " + path))));
}

TEST_F(FileModesTest, ALinkIsJudgedByItsFile) {
  const std::string link = folder_.File("link");
  std::filesystem::create_symlink(config_.tls.key_file, link);
  config_.tls.key_file = link;
  EXPECT_THAT(Check().notes, IsEmpty()) << "a link's own mode is 0777";
  Change(link, 0644);
  EXPECT_THAT(Check().notes, ::testing::SizeIs(1));
}

TEST_F(FileModesTest, APasswordThatIsNotUsedIsNotJudged) {
  Change(config_.store.password_file, 0666);
  config_.store.url = "sqlite:///tmp/x.db";
  EXPECT_THAT(Check().problems, IsEmpty());
}

TEST_F(FileModesTest, StandsBesideTheOtherProblemsOfFiles) {
  const std::string text = fmt::format(
      "[tls]\ncertificate_file = \"{0}/gone\"\nkey_file = \"{0}/s.key\"\n"
      "client_ca_file = \"{0}/gone\"\n",
      folder_.path());
  Change(config_.tls.key_file, 0666);
  EXPECT_THAT(WithFiles(ParseConfig(text, "c", {})).problems,
              Contains(AllOf(Field(&Problem::key, "tls.key_file"),
                             Field(&Problem::text, HasSubstr("may write")))));
  Change(config_.tls.key_file, 0644);
  EXPECT_THAT(WithFiles(ParseConfig(text, "c", {})).notes,
              ElementsAre(Field(&Problem::key, "tls.key_file")));
}

}  // namespace
}  // namespace uplink::config
