#include "server/fleet/top_senders.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

using std::chrono::seconds;
using ::testing::IsEmpty;

class TopSendersTest : public ::testing::Test {
 protected:
  robot::Robot& Add(const std::string& ruri, const std::string& of_fleet = "f") {
    return **fleet_.FindOrAdmit({ruri, of_fleet});
  }
  /// Each second for so long.
  void Send(robot::Robot& robot, std::size_t messages, int for_seconds) {
    for (int i = 0; i < for_seconds; ++i) {
      clock_.Advance(seconds(1));
      robot.traffic.CountMessages(messages);
      top_.Look();
    }
  }

  testing::ManualClock clock_;
  Fleet fleet_{clock_, 100, {}};
  TopSenders top_{clock_, fleet_};
};

TEST_F(TopSendersTest, NobodyIsNamedWhoSendsNothing) {
  Add("rcan://a").traffic.CountMessages(9);
  top_.Look();
  EXPECT_THAT(top_.Most(TopBy::kMessages, 10), IsEmpty()) << "it was before the first look";
}

TEST_F(TopSendersTest, ARateIsRightFromTheFirstSecondsOnAndAfterTheWindow) {
  robot::Robot& robot = Add("rcan://a");
  top_.Look();
  for (const int for_seconds : {2, 10, 300}) {
    Send(robot, 50, for_seconds);
    EXPECT_NEAR(top_.Most(TopBy::kMessages, 10).at(0).per_second, 50, 1) << for_seconds;
  }
}

TEST_F(TopSendersTest, WhatWasSentLongAgoFades) {
  robot::Robot& before = Add("rcan://a");
  robot::Robot& now = Add("rcan://b");
  top_.Look();
  Send(before, 100, 60);
  Send(now, 10, 300);
  EXPECT_EQ(top_.Most(TopBy::kMessages, 1).at(0).ruri, "rcan://b");
}

TEST_F(TopSendersTest, ComparesByWhatIsAskedAndNamesFewOfOneFleet) {
  top_.Look();
  for (std::size_t i = 0; i < 5; ++i) {
    robot::Robot& robot = Add("rcan://" + std::to_string(i), i < 4 ? "f" : "g");
    robot.traffic.CountMessages(1 + i);
    robot.traffic.CountBytes(100 - i);
    if (i == 2) robot.traffic.CountRows(7);
  }
  clock_.Advance(seconds(2));
  EXPECT_EQ(top_.Most(TopBy::kMessages, 10).at(0).ruri, "rcan://4");
  const std::vector<std::string> fleets = {"e", "f"};
  EXPECT_EQ(top_.Most(TopBy::kMessages, 10, fleets).at(0).ruri, "rcan://3");
  EXPECT_EQ(top_.Most(TopBy::kMessages, 2).size(), 2U);
  EXPECT_EQ(top_.Most(TopBy::kBytes, 10).at(0).ruri, "rcan://0");
  EXPECT_EQ(top_.Most(TopBy::kRows, 10).size(), 1U);
  EXPECT_EQ(top_.Most(TopBy::kRows, 10).at(0).fleet, "f");
}

TEST_F(TopSendersTest, NamesAtMostItsBound) {
  Fleet many(clock_, 2 * kTopMax, {});
  TopSenders top(clock_, many);
  top.Look();
  for (std::size_t i = 0; i <= kTopMax; ++i) {
    (*many.FindOrAdmit({"rcan://" + std::to_string(i), "f"}))->traffic.CountMessages(1);
  }
  clock_.Advance(seconds(2));
  EXPECT_EQ(top.Most(TopBy::kMessages, 2 * kTopMax).size(), kTopMax);
}

}  // namespace
}  // namespace uplink::fleet
