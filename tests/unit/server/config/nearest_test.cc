#include "server/config/nearest.h"

#include <vector>

#include <gtest/gtest.h>

namespace uplink::config {
namespace {

const std::vector<std::string> kNames = {"limits.robots_max", "limits.frame_bytes_max", "log.level",
                                         "log.format"};

TEST(NearestNameTest, FindsANameWithAWrongAMissingAFurtherOrASwappedByte) {
  for (const char* const wrong :
       {"limits.robot_max", "limits.robotss_max", "limits.robots_mex", "limits.robost_max"}) {
    EXPECT_EQ(NearestName(wrong, kNames), "limits.robots_max") << wrong;
  }
}

TEST(NearestNameTest, TakesAsManyEditsAsTheBoundAndNoMore) {
  EXPECT_EQ(NearestName("limits.rbts_max", kNames), "limits.robots_max");
  EXPECT_EQ(NearestName("limits.rbts_mx", kNames), std::nullopt);
}

TEST(NearestNameTest, AShortNameMustBeCloser) {
  const std::vector<std::string> names = {"pki", "store"};
  EXPECT_EQ(NearestName("pkj", names), "pki");
  EXPECT_EQ(NearestName("pxj", names), std::nullopt) << "two edits of three bytes";
  EXPECT_EQ(NearestName("pk", names), std::nullopt) << "fits anything";
  EXPECT_EQ(NearestName("", names), std::nullopt);
}

TEST(NearestNameTest, PrefersTheNameWithTheFewestEditsThenTheFirst) {
  const std::vector<std::string> names = {"robot", "robots", "robota"};
  EXPECT_EQ(NearestName("robotz", names), "robot");
  EXPECT_EQ(NearestName("robotss", names), "robots");
}

TEST(NearestNameTest, ComparesNamesUpToTheBoundAndNotPastIt) {
  const std::vector<std::string> names = {std::string(kNearNameBytesMax, 'a'),
                                          std::string(kNearNameBytesMax + 1, 'b')};
  EXPECT_EQ(NearestName(std::string(kNearNameBytesMax - 1, 'a'), names), names[0]);
  EXPECT_EQ(NearestName(std::string(kNearNameBytesMax, 'b'), names), std::nullopt);
  EXPECT_EQ(NearestName(std::string(kNearNameBytesMax + 1, 'a'), names), std::nullopt);
}

TEST(DidYouMeanTest, EndsASentenceEitherWay) {
  EXPECT_EQ(DidYouMean("log.lev3l", kNames, "; see the list"), "; did you mean log.level?");
  EXPECT_EQ(DidYouMean("nonsense", kNames, "; see the list"), "; see the list");
}

}  // namespace
}  // namespace uplink::config
