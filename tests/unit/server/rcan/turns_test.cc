#include "server/rcan/turns.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::rcan {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Sharer Gateway(const std::string& fleet, const std::string& name) {
  return {.fleet = fleet, .way = Way::kGateway, .gateway = name};
}

class ScrapeTurnsTest : public ::testing::Test {
 protected:
  /// The robots in the order of their turns, of whom each takes `series`.
  std::vector<std::size_t> Order(std::size_t series) {
    std::vector<std::size_t> order;
    turns_.Give([&](std::size_t robot) {
      order.push_back(robot);
      return ScrapeTurns::Turn{.taken = series};
    });
    return order;
  }
  /// What each robot of `robots` takes where there is room for `room` in all, and each wants
  /// `wanted`.
  void GiveRoom(std::size_t room, std::size_t wanted) {
    turns_.Give([&](std::size_t) {
      if (wanted > room) return ScrapeTurns::Turn{.left_out = wanted};
      room -= wanted;
      return ScrapeTurns::Turn{.taken = wanted};
    });
  }

  ScrapeTurns turns_;
};

TEST_F(ScrapeTurnsTest, WithoutRobotsThereAreNone) {
  EXPECT_THAT(Order(1), IsEmpty());
  EXPECT_FALSE(turns_.Greediest());
}

TEST_F(ScrapeTurnsTest, RobotsOfOneSharerComeInTheirOrder) {
  for (std::size_t robot : {3U, 1U, 2U}) turns_.Add({.fleet = "f", .way = Way::kOwnStream}, robot);
  EXPECT_THAT(Order(5), ElementsAre(3, 1, 2));
  EXPECT_THAT(Order(5), ElementsAre(3, 1, 2)) << "again at the next call";
}

TEST_F(ScrapeTurnsTest, WhoHasTakenLeastIsNext) {
  for (std::size_t robot : {0U, 1U, 2U}) turns_.Add(Gateway("f", "a"), robot);
  for (std::size_t robot : {10U, 11U, 12U}) turns_.Add(Gateway("f", "b"), robot);
  turns_.Add({.fleet = "f", .way = Way::kOwnStream}, 20);
  std::vector<std::size_t> order;
  turns_.Give([&](std::size_t robot) {
    order.push_back(robot);
    return ScrapeTurns::Turn{.taken = robot < 10 ? std::size_t{100} : std::size_t{30}};
  });
  EXPECT_THAT(order, ElementsAre(0, 10, 20, 11, 12, 1, 2));
}

TEST_F(ScrapeTurnsTest, AFleetOfManyGatewaysTakesNoMoreThanAFleetOfOne) {
  for (std::size_t i = 0; i < 4; ++i) turns_.Add(Gateway("many", std::to_string(i)), i);
  for (std::size_t i = 10; i < 14; ++i) turns_.Add(Gateway("one", "g"), i);
  EXPECT_THAT(Order(5), ElementsAre(0, 10, 1, 11, 2, 12, 3, 13));
}

TEST_F(ScrapeTurnsTest, WaysOfOneFleetShareAndGatewaysOfTheSameNameElsewhereDoNot) {
  turns_.Add(Gateway("a", "g"), 0);
  turns_.Add(Gateway("a", "g"), 1);
  turns_.Add({.fleet = "a", .way = Way::kBroker}, 2);
  turns_.Add({.fleet = "a", .way = Way::kNotHeard}, 3);
  turns_.Add({.fleet = "a", .way = Way::kOwnStream}, 4);
  turns_.Add(Gateway("b", "g"), 5);
  EXPECT_THAT(Order(1), ElementsAre(0, 5, 4, 2, 3, 1));
}

TEST_F(ScrapeTurnsTest, WhoeverFindsNoRoomKeepsItsTurn) {
  turns_.Add(Gateway("f", "a"), 0);
  turns_.Add(Gateway("f", "a"), 1);
  turns_.Add(Gateway("f", "b"), 2);
  EXPECT_THAT(Order(0), ElementsAre(0, 1, 2));
}

TEST_F(ScrapeTurnsTest, NobodyIsGreedyWhereAllHaveRoom) {
  turns_.Add(Gateway("f", "a"), 0);
  turns_.Add(Gateway("f", "b"), 1);
  GiveRoom(20, 10);
  EXPECT_FALSE(turns_.Greediest());
}

TEST_F(ScrapeTurnsTest, TheGreediestOfThoseWhoLackRoomIsNamedWithAllOfItsTurns) {
  for (std::size_t i = 0; i < 3; ++i) turns_.Add(Gateway("f", "a"), i);
  for (std::size_t i = 0; i < 5; ++i) turns_.Add(Gateway("f", "b"), i);
  turns_.Add({.fleet = "f", .way = Way::kOwnStream}, 9);
  GiveRoom(100, 1);
  GiveRoom(50, 10);
  const auto most = turns_.Greediest();
  ASSERT_TRUE(most);
  EXPECT_EQ(most->sharer, Gateway("f", "b"));
  EXPECT_EQ(most->series.taken, 5U + 20U);
  EXPECT_EQ(most->series.left_out, 30U);
  turns_.Clear();
  EXPECT_FALSE(turns_.Greediest());
}

TEST(Ways, HaveAWordEach) {
  EXPECT_EQ(ToText(Way::kGateway), "gateway");
  EXPECT_EQ(ToText(Way::kOwnStream), "own_stream");
  EXPECT_EQ(ToText(Way::kBroker), "broker");
  EXPECT_EQ(ToText(Way::kNotHeard), "not_heard");
}

}  // namespace
}  // namespace uplink::rcan
