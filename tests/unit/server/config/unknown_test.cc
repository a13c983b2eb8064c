#include "server/config/unknown.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/nearest.h"
#include "server/config/settings.h"

namespace uplink::config {
namespace {

using ::testing::StartsWith;

TEST(UnknownTest, AKeyIsToldTheNearest) {
  EXPECT_EQ(UnknownKeyText("limits", "robot_max"), "unknown key; did you mean limits.robots_max?");
  EXPECT_EQ(UnknownKeyText("store", "retention.hist0ry"),
            "unknown key; did you mean store.retention.history?");
}

TEST(UnknownTest, AKeyOfAnotherSectionIsToldThatSection) {
  EXPECT_EQ(UnknownKeyText("limits", "topic_prefixes"),
            "unknown key; did you mean cyberwave.topic_prefixes?");
}

TEST(UnknownTest, WhatIsNearNothingIsToldWhereToLook) {
  EXPECT_THAT(UnknownKeyText("limits", "nonsense"), StartsWith("unknown key; delete it, or"));
  EXPECT_THAT(UnknownSectionText("nonsense"), StartsWith("unknown section; delete it, or"));
  EXPECT_EQ(UnknownVariableText("UPLINKD_NONSENSE"),
            "no key has this variable; unset it: variables are UPLINKD_<SECTION>_<KEY>");
}

TEST(UnknownTest, ASectionAndAVariableAreToldTheNearest) {
  EXPECT_EQ(UnknownSectionText("limit"), "unknown section; did you mean limits?");
  EXPECT_EQ(UnknownVariableText("UPLINKD_LIMITS_ROBOT_MAX"),
            "no key has this variable; did you mean UPLINKD_LIMITS_ROBOTS_MAX?");
}

TEST(UnknownTest, AKeyOutsideItsSectionIsToldThatSection) {
  EXPECT_THAT(KeyOutsideText("robot_share"), ::testing::EndsWith(" such as [journal]"));
  EXPECT_THAT(KeyOutsideText("nonsense"), ::testing::EndsWith(" such as [listen]"));
}

TEST(UnknownTest, EveryNameOfASettingIsCompared) {
  for (const Setting& setting : Settings()) {
    EXPECT_LE(FullKey(setting).size(), kNearNameBytesMax);
    EXPECT_LE(EnvironmentName(setting).size(), kNearNameBytesMax);
  }
}

}  // namespace
}  // namespace uplink::config
