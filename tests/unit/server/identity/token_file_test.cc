#include "server/identity/token_file.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace uplink::identity {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class TokenFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string Write(const std::string& text) const {
    std::ofstream(folder_.File("f")) << text;
    return folder_.File("f");
  }
  [[nodiscard]] std::string ScrapeFlaw(const std::string& text) const {
    return std::string(ReadScrapeToken(Write(text)).status().message());
  }

  uplink::testing::TempFolder folder_;
};

TEST_F(TokenFileTest, ReadsAFileWithoutTokens) {
  const auto read = ReadTokenFile(Write("# none yet\n"));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->table.entries().empty());
  EXPECT_EQ(read->text, "# none yet\n");
}

TEST_F(TokenFileTest, NamesTheFileThatItCannotRead) {
  const std::string gone = folder_.File("gone");
  for (const absl::Status& status :
       {ReadTokenFile(gone).status(), ReadScrapeToken(gone).status()}) {
    EXPECT_TRUE(absl::IsFailedPrecondition(status));
    EXPECT_THAT(std::string(status.message()),
                AllOf(StartsWith(gone + ": "), HasSubstr("No such file")));
  }
  EXPECT_THAT(std::string(ReadTokenFile(Write("x")).status().message()),
              HasSubstr("/f: line 1: is no JSON object"));
}

TEST_F(TokenFileTest, AScrapeTokenIsTheFirstLine) {
  const auto hash = ReadScrapeToken(Write("0123456789abcdef\r\n# of hall 7\n"));
  ASSERT_TRUE(hash.ok()) << hash.status();
  EXPECT_TRUE(HasHash("0123456789abcdef", *hash));
  EXPECT_FALSE(HasHash("0123456789abcdef\r", *hash));
}

TEST_F(TokenFileTest, AScrapeTokenIsLongAndOfAHeadersCharacters) {
  EXPECT_EQ(ScrapeFlaw(std::string(kScrapeTokenMin, 'a')), "");
  EXPECT_EQ(ScrapeFlaw(std::string(kScrapeTokenMax, 'a') + "\n"), "");
  for (const std::string& bad :
       {std::string(), std::string("\n0123456789abcdef"), std::string(kScrapeTokenMin - 1, 'a'),
        std::string(kScrapeTokenMax + 1, 'a'), std::string("0123456789 abcdef"),
        std::string("0123456789abcde\xC3\xBC"), std::string("0123456789abcdef\0", 17)}) {
    EXPECT_THAT(ScrapeFlaw(bad), AllOf(HasSubstr("its first line is no token; write 16 to 512"),
                                       Not(HasSubstr("0123"))))
        << bad;
  }
  EXPECT_THAT(ScrapeFlaw(std::string(5000, 'a')), HasSubstr("is larger than"));
}

}  // namespace
}  // namespace uplink::identity
