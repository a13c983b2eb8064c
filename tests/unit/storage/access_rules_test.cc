#include "storage/access_rules.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

RobotSetting Nothing() { return {.ruri = "rcan://a/1"}; }

TEST(AccessRules, ABlockAndARegistrationDecideEntry) {
  RobotSetting blocked = Nothing();
  blocked.blocked = true;
  EXPECT_TRUE(DecidesEntry(blocked));
  EXPECT_FALSE(SetsNothing(blocked));
  RobotSetting registered = Nothing();
  registered.registered = true;
  EXPECT_TRUE(DecidesEntry(registered));
  EXPECT_FALSE(SetsNothing(registered));
}

TEST(AccessRules, LabelsAndANoteAreSetAndDecideNothing) {
  RobotSetting labelled = Nothing();
  labelled.labels.emplace("site", "hall2");
  RobotSetting noted = Nothing();
  noted.note = "x";
  for (const RobotSetting& each : {labelled, noted}) {
    EXPECT_FALSE(DecidesEntry(each));
    EXPECT_FALSE(SetsNothing(each));
  }
}

TEST(AccessRules, ADisconnectIsNothingThatIsSet) {
  RobotSetting setting = Nothing();
  EXPECT_TRUE(SetsNothing(setting));
  setting.disconnect_at = SystemTime();
  EXPECT_TRUE(SetsNothing(setting));
  EXPECT_FALSE(DecidesEntry(setting));
}

}  // namespace
}  // namespace uplink::storage
