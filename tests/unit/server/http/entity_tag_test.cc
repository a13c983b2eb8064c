#include "server/http/entity_tag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::http {
namespace {

using ::testing::MatchesRegex;

TEST(EntityTag, IsTheSameForTheSameTextAlone) {
  EXPECT_THAT(EntityTag(""), MatchesRegex("W/\"[0-9a-f]{32}\""));
  EXPECT_EQ(EntityTag("a"), EntityTag("a"));
  EXPECT_NE(EntityTag("a"), EntityTag("b"));
  EXPECT_NE(EntityTag("a"), EntityTag(""));
}

TEST(NamesTag, FindsItInAListByTheWeakComparison) {
  for (const char* header : {R"(W/"a")", R"("a")", R"("x", W/"a")", R"(  "x" ,, "y",W/"a" , "z")",
                             R"("x""a")", R"("x,y", "a")", "*", " * "}) {
    EXPECT_TRUE(NamesTag(header, R"(W/"a")")) << header;
  }
}

TEST(NamesTag, TakesNothingElseForIt) {
  for (const char* header : {"", " ", ",", "a", R"("b")", R"(W/"b", "c")", R"("A")", R"("a)",
                             R"(a")", R"("aa")", R"(W/a)", R"(w/"a")", R"(W/ "a")", R"(x, "a")",
                             R"("x" y, "a")", R"(*, "a")", "**", R"("*")", R"("")"}) {
    EXPECT_FALSE(NamesTag(header, R"(W/"a")")) << header;
  }
}

}  // namespace
}  // namespace uplink::http
