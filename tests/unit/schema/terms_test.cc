#include <gtest/gtest.h>

#include "schema/model/mission.h"
#include "schema/model/presence.h"

namespace uplink::model {
namespace {

TEST(IsTerminalTest, HoldsForTheEndsOfARunAlone) {
  for (const MissionStatus status :
       {MissionStatus::kAborted, MissionStatus::kComplete, MissionStatus::kError}) {
    EXPECT_TRUE(IsTerminal(status)) << EnumText(status);
  }
  for (const MissionStatus status :
       {MissionStatus::kUnknown, MissionStatus::kReady, MissionStatus::kStarting,
        MissionStatus::kRunning, MissionStatus::kPaused, MissionStatus::kBlocked,
        static_cast<MissionStatus>(9)}) {
    EXPECT_FALSE(IsTerminal(status)) << EnumText(status);
  }
}

TEST(PresenceText, IsReadBack) {
  EXPECT_EQ(ToText(Presence::kUnknown), "unknown");
  EXPECT_EQ(ToText(Presence::kOnline), "online");
  EXPECT_EQ(ToText(Presence::kOffline), "offline");
  for (const Presence presence : {Presence::kUnknown, Presence::kOnline, Presence::kOffline}) {
    EXPECT_EQ(PresenceFromText(ToText(presence)), presence);
  }
  for (const char* text : {"", "Online", "online ", "on"}) {
    EXPECT_EQ(PresenceFromText(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace uplink::model
