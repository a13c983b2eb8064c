// How much one robot makes all others receive, and what waits for that.
#include "server/forward/paces.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/forward/limits.h"
#include "tests/unit/server/forward/receiving.h"

namespace uplink::forward {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::SizeIs;
using Turn = Paces::Turn;

constexpr Paces::Limits kLimits = {.fan_out = {.rate = 1000, .burst = 2000}, .waiting_max = 1000};

class PacesTest : public ::testing::Test {
 protected:
  [[nodiscard]] bool New(const ItemKey& key) { return paces_.Passes(key, Turn::kNew, now_); }
  [[nodiscard]] bool Waited(const ItemKey& key) { return paces_.Passes(key, Turn::kWaited, now_); }
  void Forwarded(const std::string& robot, std::size_t bytes) {
    paces_.NoteForwarded(robot, bytes, now_);
  }

  SteadyTime now_ = SteadyTime() + std::chrono::hours(1);
  Paces paces_{kLimits};
};

TEST_F(PacesTest, WhoIsWithinThePaceNeverWaits) {
  EXPECT_TRUE(New(KeyOf("a", "1")));
  Forwarded("a", 2000);
  now_ += milliseconds(1);
  EXPECT_TRUE(New(KeyOf("a", "2")));
  EXPECT_EQ(paces_.waiting(), 0U);
  EXPECT_FALSE(paces_.DueAt(now_));
  EXPECT_THAT(paces_.Due(now_), IsEmpty());
}

TEST_F(PacesTest, WhoIsOverItWaitsAndNobodyElse) {
  Forwarded("a", 2000);
  EXPECT_FALSE(New(KeyOf("a", "1")));
  EXPECT_FALSE(New(KeyOf("a", "1"))) << "once";
  EXPECT_FALSE(New(KeyOf("a", "2")));
  EXPECT_TRUE(New(KeyOf("b", "1")));
  EXPECT_EQ(paces_.waiting(), 2U);
  EXPECT_THAT(paces_.robots(), ElementsAre(Key("a")));
}

TEST_F(PacesTest, OneChangePassesAFullBucketHoweverLargeAndIsPaidForAfterwards) {
  Forwarded("a", 10'000);
  EXPECT_FALSE(New(KeyOf("a", "1")));
  EXPECT_THAT(paces_.DueAt(now_), now_ + seconds(10)) << "when it is full again";
  now_ += seconds(10) - milliseconds(1);
  EXPECT_THAT(paces_.Due(now_), IsEmpty());
  now_ += milliseconds(1);
  EXPECT_THAT(paces_.Due(now_), ElementsAre(KeyOf("a", "1")));
}

TEST_F(PacesTest, WhatWaitsIsDueByItsRateAndInTurn) {
  Forwarded("a", 3000);
  for (const char* id : {"1", "2", "3"}) EXPECT_FALSE(New(KeyOf("a", id)));
  Forwarded("a", 500);
  now_ += seconds(2);
  // 500 may be taken: as much as the last one took.
  EXPECT_THAT(paces_.Due(now_), ElementsAre(KeyOf("a", "1")));
  EXPECT_TRUE(Waited(KeyOf("a", "1")));
  Forwarded("a", 500);
  EXPECT_FALSE(New(KeyOf("a", "1"))) << "behind those that wait";
  now_ += milliseconds(500);
  EXPECT_THAT(paces_.Due(now_), ElementsAre(KeyOf("a", "2")));
  EXPECT_TRUE(Waited(KeyOf("a", "2")));
  Forwarded("a", 500);
  now_ += milliseconds(500);
  EXPECT_THAT(paces_.Due(now_), ElementsAre(KeyOf("a", "3")));
  EXPECT_TRUE(Waited(KeyOf("a", "3")));
  EXPECT_THAT(paces_.Due(now_), ElementsAre(KeyOf("a", "1")));
}

TEST_F(PacesTest, WhatIsDueAndProvesTooLargeWaitsOn) {
  Forwarded("a", 4000);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_FALSE(New(KeyOf("a", std::to_string(i))));
  Forwarded("a", 1);
  now_ += seconds(4);
  const std::vector<ItemKey> due = paces_.Due(now_);
  ASSERT_THAT(due, SizeIs(20)) << "small ones, by the last one";
  EXPECT_TRUE(Waited(due[0]));
  Forwarded("a", 50'000);
  EXPECT_FALSE(Waited(due[1]));
  EXPECT_EQ(paces_.waiting(), 19U);
}

TEST_F(PacesTest, WhatIsGoneWaitsNoMore) {
  Forwarded("a", 9000);
  EXPECT_FALSE(New(KeyOf("a", "1")));
  EXPECT_FALSE(New(KeyOf("a", "2")));
  paces_.Forget(KeyOf("a", "1"));
  paces_.Forget(KeyOf("b", "1"));
  EXPECT_EQ(paces_.waiting(), 1U);
  paces_.ForgetAll();
  EXPECT_EQ(paces_.waiting(), 0U);
  EXPECT_THAT(paces_.robots(), IsEmpty());
}

TEST_F(PacesTest, PastTheBoundNothingMoreWaits) {
  Forwarded("a", 9000);
  for (std::size_t i = 0; i < kLimits.waiting_max; ++i) {
    EXPECT_FALSE(New(KeyOf("a", std::to_string(i))));
  }
  EXPECT_TRUE(New(KeyOf("a", "more")));
  EXPECT_FALSE(New(KeyOf("a", "0"))) << "it has a place";
  paces_.Forget(KeyOf("a", "0"));
  EXPECT_FALSE(New(KeyOf("a", "more")));
}

TEST_F(PacesTest, OneLookHasABoundAndRobotsTakeTurns) {
  const Paces::Limits wide = {.fan_out = {.rate = 1'000'000, .burst = 1'000'000},
                              .waiting_max = 100'000};
  Paces paces(wide);
  constexpr std::size_t kRobots = 2 * kDueMax / kLookedUpMax;
  for (std::size_t robot = 0; robot < kRobots; ++robot) {
    const std::string name = std::to_string(10 + robot);
    paces.NoteForwarded(name, 2'000'000, now_);
    for (std::size_t i = 0; i < kLookedUpMax; ++i) {
      EXPECT_FALSE(paces.Passes(KeyOf(name, std::to_string(i)), Turn::kNew, now_));
    }
    paces.NoteForwarded(name, 1, now_);
  }
  now_ += seconds(60);
  const std::vector<ItemKey> first = paces.Due(now_);
  const std::vector<ItemKey> second = paces.Due(now_);
  EXPECT_THAT(first, SizeIs(kDueMax));
  EXPECT_THAT(second, SizeIs(kDueMax));
  EXPECT_LT(first.back().ruri, second.front().ruri);
  EXPECT_EQ(paces.Due(now_).front(), first.front()) << "they wait until they pass";
}

TEST_F(PacesTest, TheBoundOfOneLookHoldsForAnyNumberOfItems) {
  const Paces::Limits wide = {.fan_out = {.rate = 1'000'000, .burst = 1'000'000},
                              .waiting_max = 100'000};
  Paces paces(wide);
  for (const char* robot : {"a", "b", "c", "d", "e"}) {
    paces.NoteForwarded(robot, 2'000'000, now_);
    for (std::size_t i = 0; i < kLookedUpMax - 6; ++i) {
      EXPECT_FALSE(paces.Passes(KeyOf(robot, std::to_string(i)), Turn::kNew, now_));
    }
    paces.NoteForwarded(robot, 1, now_);
  }
  now_ += seconds(60);
  EXPECT_THAT(paces.Due(now_), SizeIs(kDueMax));
}

TEST_F(PacesTest, ARateOfNothingIsNoBound) {
  Paces paces({.fan_out = {}, .waiting_max = 1});
  paces.NoteForwarded("a", 1'000'000'000, now_);
  EXPECT_TRUE(paces.Passes(KeyOf("a", "1"), Turn::kNew, now_));
}

}  // namespace
}  // namespace uplink::forward
