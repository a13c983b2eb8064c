// What the shared set may take, and one robot of it.
#include "server/forward/shares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::Pair;

TEST(SharesTest, ARobotEndsAtItsShareAndTheOthersGoOn) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 100, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 40));
  EXPECT_FALSE(shares.Resize({"a", "f"}, 0, 1));
  EXPECT_TRUE(shares.Resize({"b", "f"}, 0, 40));
  EXPECT_EQ(shares.bytes(), 80U);
}

TEST(SharesTest, AllEndAtTheWhole) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 100, .robot_bytes_max = 60});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 60));
  EXPECT_TRUE(shares.Resize({"b", "f"}, 0, 40));
  EXPECT_FALSE(shares.Resize({"c", "f"}, 0, 1));
  EXPECT_TRUE(shares.Resize({"a", "f"}, 60, 59));
  EXPECT_TRUE(shares.Resize({"c", "f"}, 0, 1));
}

TEST(SharesTest, WhatDoesNotFitChangesNothing) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 100, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 30));
  EXPECT_FALSE(shares.Resize({"a", "f"}, 30, 41));
  EXPECT_EQ(shares.bytes(), 30U);
  EXPECT_TRUE(shares.Resize({"a", "f"}, 30, 0));
  EXPECT_EQ(shares.bytes(), 0U);
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 40));
}

TEST(SharesTest, WhatIsLeftOutCountsUntilTheLookAfterItHasEnded) {
  Shares shares({.bytes_max = 1, .fleet_bytes_max = 1, .robot_bytes_max = 1});
  EXPECT_EQ(shares.left_out(), 0U);
  shares.NoteLeftOut({"a", "f"});
  shares.NoteLeftOut({"a", "f"});
  shares.NoteLeftOut({"b", "f"});
  EXPECT_EQ(shares.left_out(), 3U);
  EXPECT_THAT(shares.robots_left_out(), ElementsAre(Key("a"), Key("b")));
  shares.BeginLook("a");
  EXPECT_EQ(shares.left_out(), 3U) << "none of them is there yet";
  shares.NoteLeftOut({"a", "f"});
  shares.EndLook();
  EXPECT_EQ(shares.left_out(), 2U);
  shares.BeginLookAtAll();
  shares.BeginLookAtAll();  // the first one failed
  shares.EndLook();
  EXPECT_EQ(shares.left_out(), 0U);
  EXPECT_THAT(shares.robots_left_out(), IsEmpty());
}

TEST(SharesTest, ARobotIsLookedAtAgainOnceItGaveSomeBack) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 100, .robot_bytes_max = 10});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 10));
  EXPECT_TRUE(shares.Resize({"b", "f"}, 0, 10));
  EXPECT_FALSE(shares.Resize({"a", "f"}, 0, 5));
  shares.NoteLeftOut({"a", "f"});
  EXPECT_THAT(shares.DueForLook(), IsEmpty());
  EXPECT_TRUE(shares.Resize({"b", "f"}, 10, 0));
  EXPECT_THAT(shares.DueForLook(), IsEmpty()) << "that is another's share";
  EXPECT_TRUE(shares.Resize({"a", "f"}, 10, 9));
  EXPECT_THAT(shares.DueForLook(), ElementsAre("a"));
  shares.BeginLook("a");
  EXPECT_THAT(shares.DueForLook(), IsEmpty());
}

TEST(SharesTest, WhereAllIsFullWhatAnybodyGivesBackIsRoom) {
  Shares shares({.bytes_max = 20, .fleet_bytes_max = 20, .robot_bytes_max = 10});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 0, 10));
  EXPECT_TRUE(shares.Resize({"b", "f"}, 0, 10));
  EXPECT_FALSE(shares.Resize({"c", "f"}, 0, 1));
  shares.NoteLeftOut({"c", "f"});
  EXPECT_TRUE(shares.Resize({"a", "f"}, 10, 5));
  EXPECT_THAT(shares.DueForLook(), ElementsAre("c"));
}

TEST(SharesTest, AFleetEndsAtItsShareAndTheOthersGoOn) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 30, .robot_bytes_max = 20});
  EXPECT_TRUE(shares.Resize({"a", "north"}, 0, 20));
  EXPECT_TRUE(shares.Resize({"b", "north"}, 0, 10));
  EXPECT_FALSE(shares.Resize({"b", "north"}, 0, 1));
  shares.NoteLeftOut({"b", "north"});
  EXPECT_TRUE(shares.Resize({"c", "south"}, 0, 20));
  EXPECT_TRUE(shares.Resize({"a", "north"}, 20, 10));
  EXPECT_THAT(shares.DueForLook(), ElementsAre("b")) << "another of its fleet gave some back";
  EXPECT_TRUE(shares.Resize({"b", "north"}, 0, 1));
}

TEST(SharesTest, WhoTakesMostGivesWayToWhoTakesLittle) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 60, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize({"big", "north"}, 0, 40));
  EXPECT_TRUE(shares.Resize({"small", "north"}, 0, 20));
  const auto who = shares.ChooseToGiveWay({"new", "north"}, 0, 20);
  ASSERT_TRUE(who);
  EXPECT_EQ(who->ruri, "big");
  EXPECT_EQ(who->fleet, "north");
  EXPECT_FALSE(shares.ChooseToGiveWay({"new", "north"}, 0, 21))
      << "that is over half of what it has";
  EXPECT_FALSE(shares.ChooseToGiveWay({"big", "north"}, 40, 41)) << "it is over its own share";
  EXPECT_TRUE(shares.Resize({"big", "north"}, 40, 30));
  EXPECT_FALSE(shares.ChooseToGiveWay({"big", "north"}, 30, 40)) << "to no other";
  EXPECT_EQ(shares.MostOf("north"), "big");
  EXPECT_EQ(shares.MostOf("south"), "");
}

TEST(SharesTest, WhereAllAreFullTheLargestFleetGivesWay) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 60, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize({"a", "north"}, 0, 30));
  EXPECT_TRUE(shares.Resize({"b", "north"}, 0, 25));
  EXPECT_TRUE(shares.Resize({"c", "south"}, 0, 40));
  EXPECT_FALSE(shares.Resize({"d", "east"}, 0, 10));
  const auto who = shares.ChooseToGiveWay({"d", "east"}, 0, 10);
  ASSERT_TRUE(who);
  EXPECT_EQ(who->ruri, "a") << "of the fleet that takes most, though c alone takes more";
}

TEST(SharesTest, WhatCannotFitIsKnownBefore) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 60, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.MayFit({"a", "north"}, 40));
  EXPECT_FALSE(shares.MayFit({"a", "north"}, 41));
  EXPECT_TRUE(shares.Resize({"a", "north"}, 0, 40));
  EXPECT_TRUE(shares.Resize({"b", "north"}, 0, 20));
  EXPECT_FALSE(shares.MayFit({"a", "north"}, 1));
  EXPECT_TRUE(shares.MayFit({"c", "north"}, 20)) << "a gives way";
  EXPECT_FALSE(shares.MayFit({"c", "north"}, 21));
}

TEST(SharesTest, WhoIsLeftOutIsToldWithWhoTakesMostOfItsFleet) {
  Shares shares({.bytes_max = 100, .fleet_bytes_max = 60, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize({"big", "north"}, 0, 40));
  shares.NoteLeftOut({"x", "north"});
  shares.NoteLeftOut({"y", "south"});
  EXPECT_THAT(shares.robots_left_out(), ElementsAre(Pair("x", "big"), Pair("y", "")));
}

}  // namespace
}  // namespace uplink::forward
