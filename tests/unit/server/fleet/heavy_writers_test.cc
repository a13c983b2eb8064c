#include "server/fleet/heavy_writers.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr seconds kLook{10};
constexpr std::uint64_t kRate = 1000;

class HeavyWritersTest : public ::testing::Test {
 protected:
  RobotPtr Add(const std::string& ruri) {
    robots_.push_back(*fleet_.FindOrAdmit({ruri, "f"}));
    return robots_.back();
  }
  void Store(robot::Robot& robot, std::uint64_t bytes) {
    robot.flow.Take(bytes, limits_, clock_.Steady());
  }
  /// Looks for so long; each robot stores `rates`, in bytes per second, in their order.
  void Pass(milliseconds span, const std::vector<std::uint64_t>& rates) {
    for (; span.count() > 0; span -= kLook) {
      clock_.Advance(kLook);
      for (std::size_t i = 0; i < rates.size(); ++i) Store(*robots_[i], rates[i] * kLook.count());
      writers_.Sample(robots_, kLook);
    }
  }
  std::vector<std::string> Named() {
    std::vector<std::string> ruris;
    for (const HeavyWriters::Writer& writer : writers_.Name()) ruris.push_back(writer.ruri);
    return ruris;
  }

  testing::ManualClock clock_;
  const robot::FlowLimits limits_{};
  Fleet fleet_{clock_, 10'000, {}};
  std::vector<RobotPtr> robots_;
  HeavyWriters writers_;
};

TEST_F(HeavyWritersTest, OneGreedyRobotOfFiveIsNamedOnce) {
  for (const char* ruri : {"a", "b", "c", "d", "greedy"}) Add(ruri);
  Pass(hours(1), {kRate, kRate, kRate, kRate, 100 * kRate});
  const std::vector<HeavyWriters::Writer> named = writers_.Name();
  ASSERT_EQ(named.size(), 1U);
  EXPECT_EQ(named.front().ruri, "greedy");
  EXPECT_NEAR(static_cast<double>(named.front().bytes_per_hour), 100.0 * kRate * 3600,
              kRate * 3600);
  EXPECT_NEAR(static_cast<double>(writers_.rate()), kRate, 0.01 * kRate);
  EXPECT_TRUE(writers_.IsNamed(*robots_[4]));
  EXPECT_FALSE(writers_.IsNamed(*robots_[0]));
  EXPECT_EQ(writers_.named(), 1U);
  EXPECT_THAT(Named(), IsEmpty()) << "it is named already";
}

TEST_F(HeavyWritersTest, AHeavyOneIsFoundAndItsRateIsRightAfterTheFirstMinute) {
  for (const char* ruri : {"a", "b", "greedy"}) Add(ruri);
  Pass(minutes(1), {kRate, kRate, 100 * kRate});
  EXPECT_THAT(Named(), ElementsAre("greedy"));
  EXPECT_NEAR(static_cast<double>(writers_.rate()), kRate, 0.02 * kRate);
}

TEST_F(HeavyWritersTest, FourTimesTheMedianAreNotTooMuchAndMoreAre) {
  for (const char* ruri : {"a", "b", "c", "d", "e"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, kRate, kHeavyTimes * kRate, kHeavyTimes * kRate + 10});
  EXPECT_THAT(Named(), ElementsAre("e"));
}

TEST_F(HeavyWritersTest, AmongEqualsNobodyIsNamed) {
  for (const char* ruri : {"a", "b", "c"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, kRate});
  EXPECT_THAT(Named(), IsEmpty());
}

TEST_F(HeavyWritersTest, OneAloneIsTheMedian) {
  for (const char* ruri : {"alone", "silent", "silent too"}) Add(ruri);
  Pass(minutes(10), {1000 * kRate});
  EXPECT_THAT(Named(), IsEmpty());
}

TEST_F(HeavyWritersTest, OfTwoTheLighterOneIsTheMedian) {
  for (const char* ruri : {"a", "greedy"}) Add(ruri);
  Pass(minutes(10), {kRate, 5 * kRate});
  EXPECT_THAT(Named(), ElementsAre("greedy"));
}

TEST_F(HeavyWritersTest, WithoutRobotsOrRowsThereIsNoMedian) {
  writers_.Sample(robots_, kLook);
  EXPECT_EQ(writers_.median(), 0U);
  Add("silent");
  Pass(minutes(1), {});
  EXPECT_EQ(writers_.median(), 0U);
  EXPECT_THAT(Named(), IsEmpty());
  EXPECT_EQ(writers_.rate(), kHeavyRateMin) << "never nothing";
}

TEST_F(HeavyWritersTest, WhoStoresLessThanTheLeastRateIsNotNamed) {
  for (const char* ruri : {"a", "b", "c"}) Add(ruri);
  Pass(hours(1), {1, 1, kHeavyRateMin - 1});
  EXPECT_THAT(Named(), IsEmpty()) << "it would be given more than it stores";
  Pass(hours(1), {1, 1, 2 * kHeavyRateMin});
  EXPECT_THAT(Named(), ElementsAre("c"));
  EXPECT_EQ(writers_.rate(), kHeavyRateMin);
}

TEST_F(HeavyWritersTest, WhatWasStoredLongAgoCountsNoMore) {
  for (const char* ruri : {"a", "b", "c", "d"}) Add(ruri);
  // Two that fell silent with little: they are no median for the others.
  Pass(minutes(1), {1, 1, kRate, kRate});
  Pass(hours(1) - kLook, {0, 0, kRate, 2 * kRate});
  EXPECT_LT(writers_.median(), kRate * 1800);
  Pass(kLook, {0, 0, kRate, 2 * kRate});
  EXPECT_GT(writers_.median(), kRate * 1800);
}

TEST_F(HeavyWritersTest, AnHoursBacklogAtOnceIsNotHeavy) {
  for (const char* ruri : {"a", "b", "away"}) Add(ruri);
  Pass(hours(3), {kRate, kRate, kRate});
  Pass(hours(1), {kRate, kRate, 0});
  Store(*robots_[2], kRate * 3600);
  Pass(kLook, {kRate, kRate, kRate});
  EXPECT_THAT(Named(), IsEmpty());
}

TEST_F(HeavyWritersTest, TimeInWhichNobodyMayStoreDoesNotCount) {
  for (const char* ruri : {"a", "b", "c"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, 100 * kRate});
  const std::uint64_t before = writers_.median();
  for (int i = 0; i < 1000; ++i) writers_.Sample(robots_, milliseconds(0));
  EXPECT_EQ(writers_.median(), before);
  EXPECT_THAT(Named(), ElementsAre("c"));
}

TEST_F(HeavyWritersTest, WhoIsNamedStaysSoUntilTheRelease) {
  for (const char* ruri : {"a", "b", "greedy"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, 100 * kRate});
  EXPECT_THAT(Named(), ElementsAre("greedy"));
  Pass(hours(10), {kRate, kRate, kRate});
  EXPECT_THAT(Named(), IsEmpty());
  EXPECT_TRUE(writers_.IsNamed(*robots_[2]));
  writers_.Release();
  EXPECT_FALSE(writers_.IsNamed(*robots_[2]));
  EXPECT_EQ(writers_.named(), 0U);
  EXPECT_THAT(Named(), IsEmpty()) << "it stores as much as the others";
}

TEST_F(HeavyWritersTest, ManyAreNamedHeaviestFirst) {
  for (const char* ruri : {"a", "b", "c", "heavy", "heaviest"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, kRate, 10 * kRate, 20 * kRate});
  EXPECT_THAT(Named(), ElementsAre("heaviest", "heavy"));
}

TEST_F(HeavyWritersTest, RobotsLeaveMemoryAndAreForgotten) {
  for (const char* ruri : {"a", "b", "greedy"}) Add(ruri);
  Pass(minutes(10), {kRate, kRate, 100 * kRate});
  EXPECT_THAT(Named(), ElementsAre("greedy"));
  const std::weak_ptr<robot::Robot> greedy = robots_.back();
  robots_.pop_back();
  EXPECT_EQ(greedy.use_count(), 2) << "the fleet's own, and no more";
  Pass(kLook, {kRate, kRate});
  EXPECT_EQ(writers_.named(), 0U);
}

}  // namespace
}  // namespace uplink::fleet
