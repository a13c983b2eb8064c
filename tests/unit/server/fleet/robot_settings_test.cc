#include "server/fleet/robot_settings.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::fleet {
namespace {

using storage::AccessVersion;
using storage::RobotSetting;

constexpr const char* kOne = "rcan://f/one";
constexpr const char* kTwo = "rcan://f/two";

RobotSetting Blocked(const std::string& ruri, AccessVersion version) {
  return {.ruri = ruri, .blocked = true, .blocked_why = "stolen", .version = version};
}

RobotSetting Noted(const std::string& ruri, AccessVersion version) {
  return {.ruri = ruri, .note = "in the hall", .version = version};
}

class RobotSettingsTest : public ::testing::Test {
 protected:
  RobotSettingsTest() {
    settings_.OnChange([this](std::span<const RobotSettings::Change> changes) {
      told_.assign(changes.begin(), changes.end());
    });
  }

  RobotSettings settings_{2};
  /// Of the last Apply or Replace that changed anything.
  std::vector<RobotSettings::Change> told_;
};

TEST_F(RobotSettingsTest, HoldsWhatIsSetUntilItIsTakenBack) {
  EXPECT_EQ(settings_.Find(kOne), nullptr);
  settings_.Apply({Blocked(kOne, 1)});
  ASSERT_NE(settings_.Find(kOne), nullptr);
  EXPECT_TRUE(settings_.Find(kOne)->blocked);
  settings_.Apply({{.ruri = kOne, .version = 2}});
  EXPECT_EQ(settings_.Find(kOne), nullptr);
  EXPECT_EQ(settings_.size(), 0U);
}

TEST_F(RobotSettingsTest, TellsWhatWasAndWhatIs) {
  settings_.Apply({Blocked(kOne, 1)});
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_EQ(told_[0].before, nullptr);
  EXPECT_TRUE(told_[0].now->blocked);
  settings_.Apply({Noted(kOne, 2)});
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_TRUE(told_[0].before->blocked);
  EXPECT_EQ(*told_[0].now, Noted(kOne, 2));
}

TEST_F(RobotSettingsTest, AnOlderVersionChangesNothing) {
  settings_.Apply({Blocked(kOne, 2)});
  told_.clear();
  settings_.Apply({Noted(kOne, 1), Noted(kOne, 2)});
  EXPECT_TRUE(told_.empty());
  EXPECT_TRUE(settings_.Find(kOne)->blocked);
}

TEST_F(RobotSettingsTest, EachAskToDisconnectIsToldOnce) {
  RobotSetting setting{.ruri = kOne, .disconnect_at = FromUnixMs(1), .version = 1};
  settings_.Apply({setting});
  EXPECT_TRUE(told_.at(0).disconnect);
  setting.version = 2;
  setting.note = "in the hall";
  settings_.Apply({setting});
  EXPECT_FALSE(told_.at(0).disconnect);
  setting.version = 3;
  setting.disconnect_at = FromUnixMs(2);
  settings_.Apply({setting});
  EXPECT_TRUE(told_.at(0).disconnect);
}

TEST_F(RobotSettingsTest, ABlockReplacesANoteAtTheBound) {
  settings_.Apply({Noted(kOne, 1), Blocked(kTwo, 2)});
  EXPECT_EQ(settings_.left_out(), 0U);
  settings_.Apply({Blocked("rcan://f/three", 3)});
  EXPECT_EQ(settings_.size(), 2U);
  EXPECT_EQ(settings_.left_out(), 1U);
  EXPECT_EQ(settings_.Find(kOne), nullptr);
  EXPECT_NE(settings_.Find(kTwo), nullptr);
  EXPECT_NE(settings_.Find("rcan://f/three"), nullptr);
}

TEST_F(RobotSettingsTest, NothingReplacesABlock) {
  settings_.Apply({Blocked(kOne, 1), Blocked(kTwo, 2)});
  settings_.Apply({Blocked("rcan://f/three", 3), Noted("rcan://f/four", 4)});
  EXPECT_EQ(settings_.size(), 2U);
  EXPECT_EQ(settings_.left_out(), 2U);
  EXPECT_NE(settings_.Find(kOne), nullptr);
  EXPECT_NE(settings_.Find(kTwo), nullptr);
}

TEST_F(RobotSettingsTest, AChangeAtTheBoundKeepsItsPlace) {
  settings_.Apply({Blocked(kOne, 1), Blocked(kTwo, 2)});
  settings_.Apply({Noted(kTwo, 3)});
  EXPECT_EQ(settings_.left_out(), 0U);
  EXPECT_EQ(settings_.Find(kTwo)->note, "in the hall");
}

TEST_F(RobotSettingsTest, ReplaceForgetsWhatIsNotNamed) {
  settings_.Apply({Blocked(kOne, 7), Noted(kTwo, 8)});
  settings_.Replace(
      {{.ruri = kTwo, .blocked = true, .disconnect_at = FromUnixMs(1), .version = 2}});
  EXPECT_EQ(settings_.Find(kOne), nullptr);
  EXPECT_TRUE(settings_.Find(kTwo)->blocked);
  ASSERT_EQ(told_.size(), 2U);
  EXPECT_EQ(told_[0].ruri, kTwo);
  EXPECT_EQ(told_[0].before->note, "in the hall");
  EXPECT_FALSE(told_[0].disconnect);
  EXPECT_EQ(told_[1].ruri, kOne);
  EXPECT_EQ(told_[1].now, nullptr);
}

TEST_F(RobotSettingsTest, ReplaceTellsOnlyWhatIsOther) {
  settings_.Apply({Blocked(kOne, 1), Noted(kTwo, 2)});
  told_.clear();
  EXPECT_FALSE(settings_.Replace({Blocked(kOne, 1), Noted(kTwo, 2)}));
  EXPECT_TRUE(told_.empty());
  EXPECT_TRUE(settings_.Replace({Blocked(kOne, 1), {.ruri = kTwo, .version = 3}}));
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_EQ(told_[0].ruri, kTwo);
  EXPECT_EQ(told_[0].now, nullptr);
  EXPECT_TRUE(settings_.Find(kOne)->blocked);
}

TEST_F(RobotSettingsTest, AllAreInTheOrderOfTheirRuris) {
  settings_.Apply({Blocked(kTwo, 1), Noted(kOne, 2)});
  const auto all = settings_.All();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0]->ruri, kOne);
  EXPECT_EQ(all[1]->ruri, kTwo);
}

TEST(RobotSettingsMax, IsTwiceTheRobotsButNotFewerThanTheLeast) {
  EXPECT_EQ(RobotSettingsMax(20'000), kRobotSettingsMin);
  EXPECT_EQ(RobotSettingsMax(1'000'000), 2'000'000U);
}

}  // namespace
}  // namespace uplink::fleet
