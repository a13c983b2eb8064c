#include "server/journal/held_robots.h"

#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

class HeldRobotsTest : public ::testing::Test {
 protected:
  [[nodiscard]] Origin OriginNow() {
    return {.client = &robot_, .generation = robot_.generation()};
  }

  RecordingClient robot_{"rcan://a"};
  metrics::Ledger ledger_;
  HeldRobots held_;
};

TEST_F(HeldRobotsTest, TheFirstHoldIsNotInterrupted) {
  EXPECT_TRUE(held_.Hold(robot_, 3));
  EXPECT_EQ(held_.Since(robot_), 3U);
  EXPECT_TRUE(held_.Hold(robot_, 3)) << "another stream of the same hold";
}

TEST_F(HeldRobotsTest, AnotherEpochMeansThatAnotherProcessHeldItBetween) {
  EXPECT_TRUE(held_.Hold(robot_, 3));
  EXPECT_FALSE(held_.Hold(robot_, 5));
  EXPECT_EQ(held_.Since(robot_), 5U);
  EXPECT_TRUE(held_.Hold(robot_, 5));
}

TEST_F(HeldRobotsTest, AHoldAfterALossIsAFirstOne) {
  EXPECT_TRUE(held_.Hold(robot_, 3));
  held_.Lose(robot_);
  EXPECT_TRUE(held_.Hold(robot_, 5));
}

TEST_F(HeldRobotsTest, NothingIsCommittedOfARobotThatIsNotHeld) {
  EXPECT_FALSE(held_.MayCommit(OriginNow()));
  static_cast<void>(held_.Hold(robot_, 1));
  EXPECT_TRUE(held_.MayCommit(OriginNow()));
  held_.Lose(robot_);
  EXPECT_FALSE(held_.MayCommit(OriginNow()));
}

TEST_F(HeldRobotsTest, WhatIsVoidMayGoSinceItIsDropped) {
  const Origin origin = OriginNow();
  static_cast<void>(robot_.OnFenced(ledger_));
  EXPECT_TRUE(origin.IsVoid());
  EXPECT_TRUE(held_.MayCommit(origin));
}

}  // namespace
}  // namespace uplink::journal
