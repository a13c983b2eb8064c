#include "server/robot/parking.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using std::chrono::hours;

class ParkingTest : public ::testing::Test {
 protected:
  void Begin(SystemTime until) { parking_.Begin(until, SteadyTime::max()); }
  void Reach() { parking_.Reach({clock_.Steady(), clock_.System()}, max_); }
  /// Time passes by the monotonic clock alone.
  void ReachLater(milliseconds time) {
    parking_.Reach({clock_.Steady() + time, clock_.System()}, max_);
  }

  testing::ManualClock clock_;
  milliseconds max_ = hours(12);
  Parking parking_;
};

TEST_F(ParkingTest, LastsUntilItsTime) {
  EXPECT_EQ(parking_.until(), std::nullopt);
  const SystemTime until = clock_.System() + hours(2);
  Begin(until);
  EXPECT_EQ(parking_.until(), until);
  Reach();
  clock_.Advance(hours(2) - milliseconds(1));
  Reach();
  EXPECT_EQ(parking_.until(), until);
  clock_.Advance(milliseconds(1));
  Reach();
  EXPECT_EQ(parking_.until(), std::nullopt);
}

TEST_F(ParkingTest, ASignOfLifeEndsItOnceItsStreamHasEnded) {
  Begin(clock_.System() + hours(2));
  EXPECT_FALSE(parking_.AddSign(clock_.Steady())) << "it says more on the stream that says Goodbye";
  const SteadyTime under_way = clock_.Steady();
  clock_.Advance(milliseconds(5));
  parking_.EndStream(clock_.Steady());
  EXPECT_FALSE(parking_.AddSign(under_way));
  EXPECT_TRUE(parking_.until().has_value());
  EXPECT_TRUE(parking_.AddSign(clock_.Steady()));
  EXPECT_EQ(parking_.until(), std::nullopt);
  EXPECT_FALSE(parking_.AddSign(clock_.Steady())) << "it is back already";
}

TEST_F(ParkingTest, AnotherGoodbyeCounts) {
  Begin(clock_.System() + hours(2));
  Reach();
  Begin(clock_.System() + hours(4));
  clock_.Advance(hours(3));
  Reach();
  EXPECT_TRUE(parking_.until().has_value()) << "the deadline is the later one's, too";
}

TEST_F(ParkingTest, AClockThatIsSetBackDoesNotMakeItLonger) {
  Begin(clock_.System() + hours(2));
  Reach();
  ReachLater(hours(2) - milliseconds(1));
  EXPECT_TRUE(parking_.until().has_value());
  ReachLater(hours(2));
  EXPECT_EQ(parking_.until(), std::nullopt) << "the civil clock stood still";
}

TEST_F(ParkingTest, AClockThatIsBehindAfterARestartIsBoundByTheMaximum) {
  parking_.Follow(clock_.System() + hours(1'000));
  Reach();
  ReachLater(max_ - milliseconds(1));
  EXPECT_TRUE(parking_.until().has_value());
  ReachLater(max_);
  EXPECT_EQ(parking_.until(), std::nullopt);
}

TEST_F(ParkingTest, AClockThatJumpsAheadEndsItForGood) {
  const SystemTime until = clock_.System() + hours(2);
  Begin(until);
  parking_.Reach({clock_.Steady(), until}, max_);
  EXPECT_EQ(parking_.until(), std::nullopt);
  Reach();
  EXPECT_EQ(parking_.until(), std::nullopt) << "an alert too many, not one too few";
}

TEST_F(ParkingTest, WhatTheStoreHasEndsWithTheFirstSign) {
  const SystemTime until = clock_.System() + hours(2);
  parking_.Follow(until);
  EXPECT_EQ(parking_.until(), until);
  EXPECT_TRUE(parking_.AddSign(clock_.Steady()));
  EXPECT_EQ(parking_.until(), std::nullopt);
  parking_.Follow(until);
  EXPECT_EQ(parking_.until(), until) << "it said Goodbye elsewhere";
  parking_.Follow(std::nullopt);
  EXPECT_EQ(parking_.until(), std::nullopt) << "it came back elsewhere";
}

TEST_F(ParkingTest, WhatTheStoreStillHasStaysOver) {
  const SystemTime until = clock_.System() + hours(2);
  parking_.Follow(until);
  clock_.Advance(hours(2));
  Reach();
  parking_.Follow(until);
  EXPECT_EQ(parking_.until(), std::nullopt);
}

TEST_F(ParkingTest, LookingAgainDoesNotPutOffTheDeadline) {
  const SystemTime until = clock_.System() + hours(2);
  parking_.Follow(until);
  Reach();
  parking_.Follow(until);
  ReachLater(hours(2));
  EXPECT_EQ(parking_.until(), std::nullopt);
}

}  // namespace
}  // namespace uplink::robot
