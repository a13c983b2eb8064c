#include "server/limits/token_bucket.h"

#include <chrono>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::limits {
namespace {

using std::chrono::seconds;

class TokenBucketTest : public ::testing::Test {
 protected:
  SteadyTime Now() { return clock_.Steady(); }
  /// Takes tokens if they are there.
  bool TryTake(std::uint64_t cost) { return bucket_.TryTake(cost, size_, Now()); }

  testing::ManualClock clock_;
  BucketSize size_{.rate = 10, .burst = 100};
  TokenBucket bucket_;
};

TEST_F(TokenBucketTest, GivesItsBurstAtOnceAndThenItsRate) {
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(TryTake(1)) << i;
  EXPECT_FALSE(TryTake(1));
  EXPECT_EQ(bucket_.PassesAt(1, size_, Now()), Now() + milliseconds(100));
  EXPECT_EQ(bucket_.PassesAt(5, size_, Now()), Now() + milliseconds(500));
  clock_.Advance(milliseconds(99));
  EXPECT_FALSE(TryTake(1));
  clock_.Advance(milliseconds(1));
  EXPECT_TRUE(TryTake(1));
  EXPECT_FALSE(TryTake(1));
}

TEST_F(TokenBucketTest, IsFullAgainAfterAPause) {
  EXPECT_TRUE(TryTake(100));
  clock_.Advance(seconds(10));
  EXPECT_TRUE(TryTake(100));
  EXPECT_FALSE(TryTake(1));
  clock_.Advance(seconds(1000));
  EXPECT_TRUE(TryTake(100));
  EXPECT_FALSE(TryTake(1)) << "and not fuller";
}

TEST_F(TokenBucketTest, AFullOneGivesMoreThanItHoldsAndThenTakesItsTime) {
  EXPECT_TRUE(TryTake(250));
  clock_.Advance(milliseconds(15'000));
  EXPECT_FALSE(TryTake(1));
  EXPECT_EQ(bucket_.PassesAt(250, size_, Now()), Now() + seconds(10)) << "when it is full";
  clock_.Advance(milliseconds(100));
  EXPECT_TRUE(TryTake(1));
}

TEST_F(TokenBucketTest, OneThatIsNotFullDoesNotGiveMoreThanItHolds) {
  EXPECT_TRUE(TryTake(1));
  EXPECT_FALSE(TryTake(101));
  clock_.Advance(milliseconds(100));
  EXPECT_TRUE(TryTake(101));
}

TEST_F(TokenBucketTest, WithoutARateEverythingPasses) {
  size_ = {};
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(TryTake(1'000'000));
}

TEST_F(TokenBucketTest, AnotherSizeHoldsFromTheNextCallOn) {
  EXPECT_TRUE(TryTake(100));
  size_ = {.rate = 1000, .burst = 100};
  EXPECT_FALSE(TryTake(1)) << "it lacks as much as it did";
  clock_.Advance(milliseconds(100));
  EXPECT_TRUE(TryTake(1));
  clock_.Advance(milliseconds(100));
  EXPECT_TRUE(TryTake(100)) << "and fills as the new size says";
  size_ = {};
  EXPECT_TRUE(TryTake(1'000'000));
}

TEST_F(TokenBucketTest, NumbersWithoutEndDoNotOverflow) {
  size_ = {.rate = 1, .burst = ~std::uint64_t{0}};
  EXPECT_TRUE(TryTake(~std::uint64_t{0}));
  EXPECT_GT(bucket_.PassesAt(~std::uint64_t{0}, size_, Now()), Now());
}

TEST_F(TokenBucketTest, ARaisedRateDoesNotWaitForWhatTheOldOneOwed) {
  size_ = {.rate = 1, .burst = 20'000};
  EXPECT_TRUE(TryTake(20'000));
  size_.rate = 200;
  clock_.Advance(seconds(1));
  EXPECT_TRUE(TryTake(1)) << "20,000 s by the old rate";
  clock_.Advance(seconds(1));
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(TryTake(1)) << i;
  EXPECT_FALSE(TryTake(1));
}

TEST_F(TokenBucketTest, ASmallerBucketOwesNoMoreThanItHolds) {
  size_ = {.rate = 10, .burst = 2'000};
  EXPECT_TRUE(TryTake(2'000));
  size_.burst = 20;
  EXPECT_EQ(bucket_.PassesAt(1, size_, Now()), Now() + milliseconds(100));
}

TEST_F(TokenBucketTest, WhatItGaveMoreThanItHeldIsNotForgivenWithAnotherSize) {
  EXPECT_TRUE(TryTake(1000));
  clock_.Advance(seconds(10));
  size_ = {.rate = 20, .burst = 200};
  EXPECT_EQ(bucket_.PassesAt(200, size_, Now()), Now() + seconds(45)) << "900 lack, 20 a second";
  size_ = {.rate = 10, .burst = 50};
  EXPECT_EQ(bucket_.PassesAt(50, size_, Now()), Now() + seconds(90)) << "a smaller one neither";
}

}  // namespace
}  // namespace uplink::limits
