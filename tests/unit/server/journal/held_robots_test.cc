#include "server/journal/held_robots.h"

#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using Hold = HeldRobots::Hold;

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
  EXPECT_EQ(held_.Since(robot_), 0U);
  EXPECT_EQ(held_.Begin(robot_, 3), Hold::kNew);
  EXPECT_EQ(held_.Since(robot_), 3U);
  EXPECT_EQ(held_.Begin(robot_, 3), Hold::kSame) << "another stream of the same hold";
}

TEST_F(HeldRobotsTest, AnotherEpochMeansThatAnotherProcessHeldItBetween) {
  EXPECT_EQ(held_.Begin(robot_, 3), Hold::kNew);
  EXPECT_EQ(held_.Begin(robot_, 5), Hold::kInterrupted);
  EXPECT_EQ(held_.Since(robot_), 5U);
  EXPECT_EQ(held_.Begin(robot_, 5), Hold::kSame);
}

TEST_F(HeldRobotsTest, AHoldAfterALossIsAFirstOne) {
  EXPECT_EQ(held_.Begin(robot_, 3), Hold::kNew);
  held_.Lose(robot_);
  held_.Lose(robot_);
  EXPECT_EQ(held_.Since(robot_), 0U);
  EXPECT_EQ(held_.Begin(robot_, 5), Hold::kNew);
}

TEST_F(HeldRobotsTest, NothingIsCommittedOfARobotThatIsNotHeld) {
  EXPECT_FALSE(held_.MayCommit(OriginNow()));
  held_.Begin(robot_, 1);
  EXPECT_TRUE(held_.MayCommit(OriginNow()));
  held_.Lose(robot_);
  EXPECT_FALSE(held_.MayCommit(OriginNow()));
}

TEST_F(HeldRobotsTest, ASampleNeedsNoHold) {
  Origin origin = OriginNow();
  origin.is_sample = true;
  EXPECT_TRUE(held_.MayCommit(origin));
}

TEST_F(HeldRobotsTest, WhatIsVoidMayGoSinceItIsDropped) {
  const Origin origin = OriginNow();
  static_cast<void>(robot_.OnFenced(ledger_));
  EXPECT_TRUE(origin.IsVoid());
  EXPECT_TRUE(held_.MayCommit(origin));
}

}  // namespace
}  // namespace uplink::journal
