#include "server/fleet/fleet_tallies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::fleet {
namespace {

using ::testing::ElementsAre;

FleetTally Online(std::int64_t robots) {
  FleetTally tally;
  tally.here.online = robots;
  return tally;
}

std::vector<std::string> NamesOf(const FleetTallies& tallies) {
  std::vector<std::string> names;
  for (const auto& [name, tally] : tallies) names.push_back(name);
  return names;
}

TEST(ShownFleets, NamesAsManyAsItMay) {
  ShownFleets shown(2);
  EXPECT_THAT(NamesOf(shown.Fold({{"a", Online(1)}, {"b", Online(1)}})), ElementsAre("a", "b"));
}

TEST(ShownFleets, OneTooManyCountsAsOtherAndTheLargestAreNamed) {
  ShownFleets shown(2);
  const FleetTallies folded =
      shown.Fold({{"a", Online(1)}, {"b", Online(7)}, {"c", Online(2)}, {"d", Online(1)}});
  EXPECT_THAT(NamesOf(folded), ElementsAre("_other", "b", "c"));
  EXPECT_EQ(folded.at("_other").here.online, 2);
}

TEST(ShownFleets, RobotsOfOtherServersCountForTheSize) {
  ShownFleets shown(1);
  FleetTally away;
  away.elsewhere.offline = 5;
  const FleetTallies folded = shown.Fold({{"a", Online(4)}, {"b", away}});
  EXPECT_THAT(NamesOf(folded), ElementsAre("_other", "b"));
  EXPECT_EQ(folded.at("b").elsewhere.offline, 5);
  EXPECT_EQ(folded.at("b").here.all(), 0);
}

TEST(ShownFleets, ANamedFleetStaysWhenAnotherGrows) {
  ShownFleets shown(1);
  static_cast<void>(shown.Fold({{"a", Online(2)}, {"b", Online(1)}}));
  EXPECT_THAT(NamesOf(shown.Fold({{"a", Online(2)}, {"b", Online(9)}})),
              ElementsAre("_other", "a"));
}

TEST(ShownFleets, AFleetWithoutRobotsGivesUpItsPlace) {
  ShownFleets shown(1);
  static_cast<void>(shown.Fold({{"a", Online(2)}, {"b", Online(1)}}));
  EXPECT_THAT(NamesOf(shown.Fold({{"b", Online(1)}})), ElementsAre("b"));
}

TEST(ShownFleets, AFleetThatHasTheNameOfTheOthersIsCountedWithThem) {
  ShownFleets shown(1);
  const FleetTallies folded = shown.Fold({{"_other", Online(3)}, {"b", Online(1)}});
  EXPECT_THAT(NamesOf(folded), ElementsAre("_other"));
  EXPECT_EQ(folded.at("_other").here.online, 4);
}

TEST(ShownFleets, WithoutARobotThereAreZeros) {
  ShownFleets shown(3);
  const FleetTallies folded = shown.Fold({});
  EXPECT_THAT(NamesOf(folded), ElementsAre("_other"));
  EXPECT_EQ(folded.at("_other").robots(), 0);
}

}  // namespace
}  // namespace uplink::fleet
