#include "server/transport/crl_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "tests/support/certificates.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::transport {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;
using ::testing::SizeIs;

class CrlFilesTest : public ::testing::Test {
 protected:
  CrlFilesTest() { Write(file_.authorities, authority_.certificate()); }
  ~CrlFilesTest() override { std::filesystem::remove_all(folder_); }

  static void Write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::trunc) << text;
    ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  }
  [[nodiscard]] long Lines(const std::string& event) const {
    return std::ranges::count_if(lines_, [&event](const std::string& line) {
      return line.find(event) != std::string::npos;
    });
  }
  static std::string Make() {
    std::string name = ::testing::TempDir() + "crlXXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    return name;
  }

  const std::string folder_ = Make();
  const CrlFile file_{.lists = folder_ + "/a.crl", .authorities = folder_ + "/ca.crt"};
  const testing::TestAuthority authority_;
  const testing::KeyPair keys_ = authority_.Issue(testing::RobotSpec("rcan://a/1"));
  testing::ManualClock clock_{SystemClock{}.System()};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  std::vector<CrlFile> files_{file_};
  CrlFiles crl_{[this] { return files_; }, clock_, logger_};
};

TEST_F(CrlFilesTest, AChangeIsToldOnce) {
  Write(file_.lists, authority_.Revoke({keys_}));
  EXPECT_THAT(crl_.Look(), Optional(SizeIs(1)));
  EXPECT_EQ(crl_.Look(), std::nullopt);
  Write(file_.lists, authority_.Revoke({}));
  EXPECT_THAT(crl_.Look(), Optional(IsEmpty()));
  EXPECT_EQ(Lines("crl_read"), 2);
}

TEST_F(CrlFilesTest, ABrokenFileLeavesTheLastGoodLists) {
  Write(file_.lists, authority_.Revoke({keys_}));
  ASSERT_THAT(crl_.Look(), Optional(SizeIs(1)));
  Write(file_.lists, "no list");
  EXPECT_EQ(crl_.Look(), std::nullopt);
  EXPECT_EQ(crl_.Look(), std::nullopt);
  EXPECT_EQ(Lines("crl_unreadable"), 1);
  EXPECT_TRUE(crl_.unread());
  Write(file_.lists, authority_.Revoke({keys_}));
  EXPECT_THAT(crl_.Look(), Optional(SizeIs(1)));
  EXPECT_FALSE(crl_.unread());
}

TEST_F(CrlFilesTest, AFileThatEverybodyMayWriteDoesNotCount) {
  Write(file_.lists, authority_.Revoke({keys_}));
  ASSERT_EQ(::chmod(file_.lists.c_str(), 0666), 0);
  EXPECT_EQ(crl_.Look(), std::nullopt);
  EXPECT_THAT(lines_, Contains(HasSubstr("everybody on this machine may write")));
}

TEST_F(CrlFilesTest, AnotherAuthorityNeedsAnotherList) {
  Write(file_.lists, authority_.Revoke({keys_}));
  ASSERT_THAT(crl_.Look(), Optional(SizeIs(1)));
  Write(file_.authorities, testing::TestAuthority("another").certificate());
  EXPECT_EQ(crl_.Look(), std::nullopt) << "the last good ones count";
  EXPECT_EQ(Lines("crl_unreadable"), 1);
}

TEST_F(CrlFilesTest, ListsOfNamesakesStayApart) {
  const testing::TestAuthority namesake;
  const CrlFile second{.lists = folder_ + "/b.crl", .authorities = folder_ + "/b.crt"};
  Write(second.authorities, namesake.certificate());
  Write(file_.lists, authority_.Revoke({}));
  Write(second.lists, namesake.Revoke({keys_}));
  files_.push_back(second);
  const auto revoked = crl_.Look();
  ASSERT_THAT(revoked, Optional(SizeIs(1)));
  const auto trusted = identity::ReadCertificates({"b.crt", namesake.certificate()});
  ASSERT_TRUE(trusted.ok());
  EXPECT_EQ(revoked->front().signer, identity::KeyDigestOf(*trusted->front()));
}

TEST_F(CrlFilesTest, AListThatIsOverIsToldAndCounts) {
  Write(file_.lists, authority_.Revoke({keys_}));
  ASSERT_THAT(crl_.Look(), Optional(SizeIs(1)));
  EXPECT_EQ(Lines("crl_expired"), 0);
  EXPECT_FALSE(crl_.unread());
  clock_.Advance(std::chrono::hours(2));
  EXPECT_EQ(crl_.Look(), std::nullopt);
  EXPECT_EQ(crl_.Look(), std::nullopt);
  EXPECT_EQ(Lines("crl_expired"), 1);
  EXPECT_TRUE(crl_.unread());
  Write(file_.lists, authority_.Revoke({keys_}, 3 * 3600));
  EXPECT_THAT(crl_.Look(), Optional(SizeIs(1)));
  EXPECT_FALSE(crl_.unread());
}

TEST_F(CrlFilesTest, AFileThatIsNotNamedAnyMoreHasNoSay) {
  Write(file_.lists, authority_.Revoke({keys_}));
  ASSERT_THAT(crl_.Look(), Optional(SizeIs(1)));
  files_.clear();
  EXPECT_THAT(crl_.Look(), Optional(IsEmpty()));
  EXPECT_EQ(crl_.Look(), std::nullopt);
}

}  // namespace
}  // namespace uplink::transport
