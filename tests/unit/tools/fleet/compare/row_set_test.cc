#include "tools/uplink-fleet/compare/row_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class RowSetTest : public ::testing::Test {
 protected:
  bool Find(const std::string& key, std::uint64_t content) {
    return rows_.Find(key, content, [&key] { return key + " found"; });
  }
  [[nodiscard]] std::vector<std::string> Finish(std::uint64_t dropped = 0) {
    rows_.Finish(dropped);
    std::vector<std::string> texts;
    for (const Difference& each : findings_.differences()) {
      texts.push_back(each.expected + " | " + each.found);
    }
    return texts;
  }

  Findings findings_;
  RowSet rows_{Thing::kEvents, "rcan://a", findings_};
};

TEST_F(RowSetTest, RowsThatAreAsExpectedAgree) {
  rows_.Expect("a", {.content = 1, .shown = "a"});
  rows_.Expect("b", {.content = 0, .shown = "b"});
  EXPECT_TRUE(Find("a", 1));
  EXPECT_TRUE(Find("b", 7)) << "what it says is not known";
  EXPECT_THAT(Finish(), IsEmpty());
  EXPECT_EQ(findings_.Of(Thing::kEvents).expected, 2U);
  EXPECT_EQ(findings_.Of(Thing::kEvents).found, 2U);
}

TEST_F(RowSetTest, WhatIsMissingDoubledDifferentOrUnexpectedIsFound) {
  for (const char* key : {"missing", "doubled", "different"}) {
    rows_.Expect(key, {.content = 1, .shown = key});
  }
  EXPECT_TRUE(Find("doubled", 1));
  EXPECT_FALSE(Find("doubled", 1));
  EXPECT_TRUE(Find("different", 2));
  EXPECT_FALSE(Find("more", 1));
  EXPECT_THAT(Finish(),
              ElementsAre("doubled: once | 2 times: doubled found", "different | different found",
                          "nothing like it | more found", "missing | no such row"));
}

TEST_F(RowSetTest, OfOneKeyAsManyMayBeThereAsWereExpected) {
  rows_.Expect("a", {.shown = "a", .times = {.min = 1, .max = 1}});
  rows_.Expect("a", {.shown = "a", .times = {.min = 0, .max = 1}});
  EXPECT_TRUE(Find("a", 1));
  EXPECT_FALSE(Find("a", 1));
  EXPECT_THAT(Finish(), IsEmpty());
  EXPECT_EQ(findings_.Of(Thing::kEvents).expected, 2U) << "what may be there and is";
}

TEST_F(RowSetTest, NoMoreMayBeMissingThanWentForABound) {
  rows_.Expect("a", {.shown = "a"});
  rows_.Expect("b", {.shown = "b"});
  EXPECT_THAT(Finish(2), IsEmpty());
  EXPECT_THAT(Finish(1), ElementsAre("a | no such row", "b | no such row"));
}

}  // namespace
}  // namespace uplink::synthetic
