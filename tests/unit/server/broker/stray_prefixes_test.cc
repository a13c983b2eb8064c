#include "server/broker/stray_prefixes.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

std::string TopicUnder(const std::string& prefix) { return prefix + "cyberwave/twin/x/event"; }

TEST(StrayPrefixes, AreThoseThatNobodyWantsEachOnce) {
  StrayPrefixes strays({"", "site/"});
  EXPECT_FALSE(strays.Add(TopicUnder("")));
  EXPECT_FALSE(strays.Add(TopicUnder("site/")));
  EXPECT_TRUE(strays.Add(TopicUnder("old/")));
  EXPECT_FALSE(strays.Add(TopicUnder("old/")));
  EXPECT_FALSE(strays.Add("weather/today"));
  EXPECT_THAT(strays.prefixes(), ElementsAre("old/"));
  strays.Clear();
  EXPECT_TRUE(strays.Add(TopicUnder("old/")));
}

TEST(StrayPrefixes, PastTheirNumberFurtherOnesAreLetAlone) {
  StrayPrefixes strays({""});
  for (std::size_t i = 0; i < kStrayPrefixesMax; ++i) {
    EXPECT_TRUE(strays.Add(TopicUnder("old" + std::to_string(i) + "/")));
  }
  EXPECT_FALSE(strays.Add(TopicUnder("one_more/")));
  EXPECT_THAT(strays.prefixes(), SizeIs(kStrayPrefixesMax));
}

}  // namespace
}  // namespace uplink::broker
