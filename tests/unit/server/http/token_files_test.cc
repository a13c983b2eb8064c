#include "server/http/token_files.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/identity/token_line.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/temp_folder.h"

namespace uplink::http {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Finding = identity::TokenTable::Finding;

class TokenFilesTest : public ::testing::Test {
 protected:
  TokenFilesTest() { Write("tokens", LineOf(made_)); }

  static std::string LineOf(const identity::NewToken& made) {
    return identity::LineOf({.id = identity::TokenIdOf(made.hash),
                             .scope = identity::Scope::All(),
                             .hash = made.hash}) +
           "\n";
  }
  static identity::NewToken TokenOf(std::uint8_t seed) {
    std::array<std::uint8_t, identity::kTokenRandomBytes> random{};
    random.fill(seed);
    return identity::MakeToken(random);
  }
  /// As an editor or Kubernetes does it: another file takes the name.
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.File("new")) << text;
    std::filesystem::rename(folder_.File("new"), folder_.File(name));
  }
  [[nodiscard]] Finding Find(const identity::NewToken& made) const {
    return files_.tokens()->table.Find(made.token, clock_.System()).finding;
  }

  uplink::testing::TempFolder folder_;
  const identity::NewToken made_ = TokenOf(1);
  uplink::testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<uplink::testing::KeptLines>(lines_), clock_,
                      log::Format::kText, log::Level::kInfo};
  TokenFiles files_{{.tokens = folder_.File("tokens"), .scrape = {}}, logger_};
};

TEST_F(TokenFilesTest, NothingIsValidBeforeTheFirstLook) {
  EXPECT_EQ(Find(made_), Finding::kUnknown);
  ASSERT_TRUE(files_.Look().ok());
  EXPECT_EQ(Find(made_), Finding::kValid);
}

TEST_F(TokenFilesTest, FollowsChangesAndTellsEachOnce) {
  const identity::NewToken second = TokenOf(2);
  for (int look = 0; look < 2; ++look) ASSERT_TRUE(files_.Look().ok());
  const auto before = files_.tokens();
  Write("tokens", LineOf(made_) + LineOf(second));
  for (int look = 0; look < 2; ++look) ASSERT_TRUE(files_.Look().ok());
  EXPECT_EQ(Find(second), Finding::kValid);
  EXPECT_EQ(before->table.entries().size(), 1U) << "who asks meanwhile has what it began with";
  Write("tokens", LineOf(second));
  ASSERT_TRUE(files_.Look().ok());
  EXPECT_EQ(Find(made_), Finding::kUnknown);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("info tokens_read tokens=1"), HasSubstr("tokens=2"),
                                  HasSubstr("tokens=1")));
}

// The same size, within the same tick of the file system's clock.
TEST_F(TokenFilesTest, SeesAFileThatIsWrittenOverInPlace) {
  ASSERT_TRUE(files_.Look().ok());
  std::ofstream(folder_.File("tokens")) << LineOf(TokenOf(2));
  ASSERT_TRUE(files_.Look().ok());
  EXPECT_EQ(Find(made_), Finding::kUnknown);
  EXPECT_EQ(Find(TokenOf(2)), Finding::kValid);
}

TEST_F(TokenFilesTest, TheLastGoodTokensStayWhileTheFileIsBroken) {
  ASSERT_TRUE(files_.Look().ok());
  EXPECT_FALSE(files_.unread());
  lines_.clear();
  Write("tokens", LineOf(made_) + "{");
  for (int look = 0; look < 2; ++look) EXPECT_FALSE(files_.Look().ok());
  EXPECT_TRUE(files_.unread());
  EXPECT_EQ(Find(made_), Finding::kValid);
  std::filesystem::remove(folder_.File("tokens"));
  EXPECT_FALSE(files_.Look().ok());
  EXPECT_EQ(Find(made_), Finding::kValid);
  Write("tokens", LineOf(made_));
  for (int look = 0; look < 2; ++look) EXPECT_TRUE(files_.Look().ok());
  EXPECT_FALSE(files_.unread());
  EXPECT_THAT(lines_, ElementsAre(AllOf(HasSubstr("error tokens_unreadable"), HasSubstr("line 2")),
                                  HasSubstr("No such file"), HasSubstr("tokens_read tokens=1")));
}

TEST_F(TokenFilesTest, AFileThatEverybodyMayWriteIsNotUsed) {
  ASSERT_TRUE(files_.Look().ok());
  Write("tokens", "# none\n");
  ASSERT_EQ(::chmod(folder_.File("tokens").c_str(), 0606), 0);
  EXPECT_THAT(std::string(files_.Look().message()),
              HasSubstr("everybody on this machine may write"));
  EXPECT_EQ(Find(made_), Finding::kValid);
}

TEST_F(TokenFilesTest, FollowsTheTokenOfScrapes) {
  TokenFiles files({.tokens = {}, .scrape = folder_.File("scrape")}, logger_);
  EXPECT_FALSE(files.Look().ok()) << "it is not there";
  EXPECT_EQ(files.tokens()->scrape, std::nullopt);
  for (const char* const token : {"0123456789abcdef", "fedcba9876543210"}) {
    Write("scrape", std::string(token) + "\n");
    ASSERT_TRUE(files.Look().ok());
    ASSERT_TRUE(files.tokens()->scrape);
    EXPECT_TRUE(identity::HasHash(token, *files.tokens()->scrape)) << token;
  }
  Write("scrape", "short\n");
  EXPECT_FALSE(files.Look().ok());
  EXPECT_TRUE(identity::HasHash("fedcba9876543210", *files.tokens()->scrape));
  for (const std::string& line : lines_) EXPECT_THAT(line, Not(HasSubstr("fedcba")));
}

TEST_F(TokenFilesTest, WithoutFilesThereAreNoTokens) {
  TokenFiles files({}, logger_);
  EXPECT_TRUE(files.Look().ok());
  EXPECT_THAT(files.tokens()->table.entries(), IsEmpty());
  EXPECT_EQ(files.tokens()->scrape, std::nullopt);
}

}  // namespace
}  // namespace uplink::http
