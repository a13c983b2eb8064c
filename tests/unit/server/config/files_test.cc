#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/load.h"

namespace uplink::config {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ValidateFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "uplinkd_files_XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    config_.tls.certificate_file = Write("s.crt", "-----BEGIN CERTIFICATE-----\n");
    config_.tls.key_file = Write("s.key", "-----BEGIN EC PRIVATE KEY-----\n");
    config_.tls.client_ca_file = Write("ca.crt", "text\n-----BEGIN CERTIFICATE-----\n");
    config_.store.url = "sqlite://" + folder_ + "/uplinkd.db";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }

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

TEST_F(ValidateFilesTest, KnowsACertificateFromAKey) {
  std::swap(config_.tls.certificate_file, config_.tls.key_file);
  EXPECT_THAT(ValidateFiles(config_), SizeIs(2));
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
  EXPECT_THAT(problems[0].text, HasSubstr("/gone does not exist"));
}

TEST_F(ValidateFilesTest, RefusesAFolderAsTheStore) {
  config_.store.url = "sqlite://" + folder_;
  EXPECT_THAT(ValidateFiles(config_), SizeIs(1));
}

}  // namespace
}  // namespace uplink::config
