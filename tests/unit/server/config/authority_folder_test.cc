#include "server/config/authority_folder.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/identity/pem.h"
#include "tests/support/certificates.h"

namespace uplink::config {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class AuthorityFolderTest : public ::testing::Test {
 protected:
  ~AuthorityFolderTest() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path, std::ios::trunc) << text;
    ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  }
  [[nodiscard]] std::string Flaw() const {
    return std::string(ReadAuthorityFolder(folder_).status().message());
  }
  static std::string Make() {
    std::string name = ::testing::TempDir() + "authoritiesXXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    return name;
  }

  const std::string folder_ = Make();
  const testing::TestAuthority north_{"north"};
  const testing::TestAuthority south_{"south"};
};

TEST_F(AuthorityFolderTest, EachAuthorityHasItsRule) {
  Write("north.pem", north_.certificate());
  Write("north.toml", "roles = [\"robot\"]\nfleets = [\"n1\", \"n2\"]\ncrl_file = \"north.crl\"\n");
  Write("south.pem", south_.certificate());
  Write("south.toml", "");
  Write(".hidden.pem", "no certificate");
  const auto read = ReadAuthorityFolder(folder_);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->rules.size(), 2U);
  const auto trusted = identity::ReadCertificates({"all", read->pems});
  ASSERT_TRUE(trusted.ok()) << trusted.status();
  ASSERT_THAT(*trusted, SizeIs(2));
  const auto judge = [&](identity::Role role, const char* fleet, std::size_t authority) {
    return read->rules.Judge({.role = role, .fleet = fleet}, *(*trusted)[authority]).ok();
  };
  EXPECT_TRUE(judge(identity::Role::kRobot, "n2", 0));
  EXPECT_FALSE(judge(identity::Role::kRobot, "south", 0));
  EXPECT_FALSE(judge(identity::Role::kViewer, "n1", 0));
  EXPECT_TRUE(judge(identity::Role::kAdmin, "*", 1));
  ASSERT_THAT(read->lists, SizeIs(1));
  EXPECT_THAT(read->lists[0].lists, EndsWith("/north.crl"));
  EXPECT_THAT(read->lists[0].authority, EndsWith("/north.pem"));
}

TEST_F(AuthorityFolderTest, AllFleetsAreAStar) {
  Write("north.pem", north_.certificate());
  Write("north.toml", "fleets = [\"*\"]");
  EXPECT_EQ(Flaw(), "");
  Write("north.toml", "fleets = [\"*\", \"north\"]");
  EXPECT_THAT(Flaw(), HasSubstr("stands for all"));
}

TEST_F(AuthorityFolderTest, AnAuthorityWithoutItsRulesIsRefused) {
  Write("north.pem", north_.certificate());
  EXPECT_THAT(Flaw(), HasSubstr("north.toml"));
}

TEST_F(AuthorityFolderTest, WhatIsWrongIsNamed) {
  Write("north.pem", north_.certificate());
  Write("north.toml", "roles = [\"root\"]");
  EXPECT_THAT(Flaw(), HasSubstr("north.toml: roles: \"root\" is no role"));
  Write("north.toml", "roles = \"robot\"");
  EXPECT_THAT(Flaw(), HasSubstr("roles must be a list"));
  Write("north.toml", "fleets = []");
  EXPECT_THAT(Flaw(), HasSubstr("fleets must be a list"));
  Write("north.toml", "rolls = [\"robot\"]");
  EXPECT_THAT(Flaw(), HasSubstr("rolls is no key"));
  Write("north.toml", "crl_file = 7");
  EXPECT_THAT(Flaw(), HasSubstr("crl_file must be a path"));
  Write("north.toml", "roles = [");
  EXPECT_THAT(Flaw(), HasSubstr("north.toml: line 1"));
  Write("north.toml", "");
  Write("north.pem", "no certificate");
  EXPECT_THAT(Flaw(), HasSubstr("north.pem"));
}

TEST_F(AuthorityFolderTest, WhoMayWriteItChoosesWhomTheServerTrusts) {
  Write("north.pem", north_.certificate());
  Write("north.toml", "");
  ASSERT_EQ(::chmod((folder_ + "/north.toml").c_str(), 0666), 0);
  EXPECT_THAT(Flaw(), HasSubstr("everybody on this machine may write"));
  ASSERT_EQ(::chmod((folder_ + "/north.toml").c_str(), 0644), 0);
  ASSERT_EQ(::chmod(folder_.c_str(), 0777), 0);
  EXPECT_THAT(Flaw(), HasSubstr("everybody on this machine may write"));
}

TEST_F(AuthorityFolderTest, AnEmptyOrMissingFolderIsSaid) {
  EXPECT_THAT(Flaw(), HasSubstr("holds no NAME.pem"));
  EXPECT_THAT(std::string(ReadAuthorityFolder(folder_ + "/none").status().message()),
              HasSubstr("is no folder"));
}

}  // namespace
}  // namespace uplink::config
