#include "server/robot/clock_skew.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

class ClockSkewTest : public ::testing::Test {
 protected:
  /// A batch of an agent whose clock differs by `skew`, which took `delay` to arrive.
  bool Arrive(milliseconds skew, milliseconds delay = milliseconds(0)) {
    return skew_.Add(UnixMs(clock_.System() - delay + skew), clock_.System(), clock_.Steady());
  }
  [[nodiscard]] std::optional<std::int64_t> estimate() const { return skew_.estimate_ms(); }

  testing::ManualClock clock_;
  ClockSkew skew_;
};

TEST_F(ClockSkewTest, IsUnknownUntilABatchSaysItsTime) {
  EXPECT_EQ(estimate(), std::nullopt);
  EXPECT_TRUE(Arrive(milliseconds(250), milliseconds(30)));
  EXPECT_EQ(estimate(), 220) << "one batch is as good as its delay";
}

TEST_F(ClockSkewTest, TheLeastDelayedBatchDecides) {
  for (const int delay : {900, 20, 5000, 40}) {
    Arrive(seconds(-3), milliseconds(delay));
    clock_.Advance(seconds(1));
  }
  EXPECT_EQ(estimate(), -3020) << "behind by three seconds, not by eight";
  EXPECT_FALSE(Arrive(seconds(-3), seconds(30))) << "nothing new";
}

TEST_F(ClockSkewTest, AJumpForwardShowsAtOnce) {
  Arrive(seconds(0), milliseconds(10));
  clock_.Advance(seconds(1));
  EXPECT_TRUE(Arrive(hours(1), milliseconds(300)));
  EXPECT_EQ(estimate(), 3'600'000 - 300);
}

TEST_F(ClockSkewTest, AClockThatIsSetBackShowsWhenTheWindowHasPassed) {
  Arrive(seconds(0), milliseconds(10));
  SteadyTime::duration passed{0};
  while (estimate() == -10) {
    clock_.Advance(seconds(1));
    passed += seconds(1);
    ASSERT_LE(passed, 2 * kClockSkewWindow);
    Arrive(hours(-1), milliseconds(10));
  }
  EXPECT_GE(passed, kClockSkewWindow);
  EXPECT_EQ(estimate(), -3'600'010);
}

TEST_F(ClockSkewTest, RareBatchesEachDecide) {
  Arrive(seconds(5));
  clock_.Advance(2 * kClockSkewWindow);
  EXPECT_TRUE(Arrive(seconds(-5)));
  EXPECT_EQ(estimate(), -5000);
}

TEST_F(ClockSkewTest, LooksBackOverOneWindowAtLeast) {
  Arrive(seconds(0));
  clock_.Advance(kClockSkewWindow - milliseconds(1));
  Arrive(seconds(0), milliseconds(7));
  clock_.Advance(kClockSkewWindow);
  Arrive(seconds(0), seconds(9));
  EXPECT_EQ(estimate(), 0) << "the highest of the window before";
  clock_.Advance(milliseconds(1));
  Arrive(seconds(0), seconds(9));
  EXPECT_EQ(estimate(), -9000);
}

TEST_F(ClockSkewTest, ANewStreamBeginsAWindow) {
  Arrive(seconds(8));
  skew_.BeginWindow();
  EXPECT_EQ(estimate(), 8000) << "known until something newer is";
  Arrive(seconds(2));
  EXPECT_EQ(estimate(), 2000);
}

TEST_F(ClockSkewTest, WhatIsNoTimeInMillisecondsCountsAsNothing) {
  const auto add = [this](std::int64_t sent) {
    return skew_.Add(sent, clock_.System(), clock_.Steady());
  };
  const std::int64_t now = UnixMs(clock_.System());
  EXPECT_FALSE(add(now * 1000)) << "microseconds";
  EXPECT_FALSE(add(std::numeric_limits<std::int64_t>::max()));
  EXPECT_FALSE(add(now + kClockSkewMax.count() + 1));
  EXPECT_EQ(estimate(), std::nullopt);
  EXPECT_TRUE(add(now + kClockSkewMax.count()));
  skew_.BeginWindow();
  EXPECT_TRUE(add(1)) << "a clock of 1970";
  EXPECT_EQ(estimate(), 1 - now);
}

TEST_F(ClockSkewTest, WhatWasStoredGivesWayToWhatIsHeard) {
  skew_.Restore(std::nullopt);
  EXPECT_EQ(estimate(), std::nullopt);
  skew_.Restore(9);
  EXPECT_EQ(estimate(), 9);
  Arrive(milliseconds(-4));
  EXPECT_EQ(estimate(), -4);
  skew_.Restore(9);
  EXPECT_EQ(estimate(), -4);
}

}  // namespace
}  // namespace uplink::robot
