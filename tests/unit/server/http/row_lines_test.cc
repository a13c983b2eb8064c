#include "server/http/row_lines.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

TEST(LinesOfList, GiveEachRowALine) {
  const auto lines = LinesOfList(
      R"({"events":[{"a":[1,2],"b":{"c":[{},{}]}},{"a":[]}],"nextPageToken":"1.f","total":"5"})");
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->text, "{\"a\":[1,2],\"b\":{\"c\":[{},{}]}}\n{\"a\":[]}\n");
  EXPECT_EQ(lines->next_page_token, "1.f");
}

TEST(LinesOfList, OfNoRowsAreNone) {
  const auto lines = LinesOfList(R"({"events":[],"nextPageToken":""})");
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->text, "");
  EXPECT_EQ(lines->next_page_token, "");
  EXPECT_EQ(LinesOfList(R"({"fleets":[{"a":1}]})")->text, "{\"a\":1}\n");
}

TEST(LinesOfList, LeaveTextsAsTheyAre) {
  const std::string row = R"({"a":"],}{[,\"\\","b":"\\\",]","c":"\n\u005d"})";
  const auto lines = LinesOfList(R"({"events":[)" + row + "," + row + R"(],"nextPageToken":""})");
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->text, row + "\n" + row + "\n");
}

TEST(LinesOfList, KeepARowThatItsSenderBrokeOnOneLine) {
  const auto lines = LinesOfList("{\"events\":[{\"detail\":{\r\n \"a\": 1\n}}],\"b\":1}");
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->text, "{\"detail\":{   \"a\": 1 }}\n");
}

TEST(LinesOfList, AreNothingForWhatIsNoList) {
  for (const char* json : {"", "{}", "[]", R"({"ruri":"a","b":[1]})", R"({"error":{"code":"A"}})",
                           R"({"a)", R"({"a")", R"({"a":)", "openapi: 3.1.0"}) {
    EXPECT_FALSE(LinesOfList(json)) << json;
  }
  // What is cut off is read to its end, and no further.
  EXPECT_EQ(LinesOfList(R"({"a":[{"b":"\)")->text, "{\"b\":\"\\\n");
}

}  // namespace
}  // namespace uplink::http
