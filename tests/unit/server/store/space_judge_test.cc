#include "server/store/space_judge.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace uplink::store {
namespace {

using enum SpaceState;

constexpr std::uint64_t kMin = 1000;

SpaceState Judged(std::uint64_t free_bytes, SpaceState before) {
  return JudgeSpace({.free_bytes = free_bytes, .free_min = kMin, .before = before});
}

TEST(SpaceJudgeTest, BelowTheBoundItIsScarceAndBelowHalfOfItNothingIsStored) {
  EXPECT_EQ(Judged(1000, kEnough), kEnough);
  EXPECT_EQ(Judged(999, kEnough), kScarce);
  EXPECT_EQ(Judged(500, kEnough), kScarce);
  EXPECT_EQ(Judged(499, kEnough), kStopped);
  EXPECT_EQ(Judged(500, kScarce), kScarce);
  EXPECT_EQ(Judged(499, kScarce), kStopped);
  EXPECT_EQ(Judged(0, kScarce), kStopped);
}

TEST(SpaceJudgeTest, EachBoundIsReleasedAtAFifthMore) {
  EXPECT_EQ(Judged(1199, kScarce), kScarce);
  EXPECT_EQ(Judged(1200, kScarce), kEnough);
  EXPECT_EQ(Judged(599, kStopped), kStopped);
  EXPECT_EQ(Judged(600, kStopped), kScarce);
  EXPECT_EQ(Judged(1199, kStopped), kScarce);
  EXPECT_EQ(Judged(1200, kStopped), kEnough);
}

TEST(SpaceJudgeTest, WhereNothingIsAskedForThereIsAlwaysEnough) {
  EXPECT_EQ(JudgeSpace({.free_bytes = 0, .free_min = 0, .before = kEnough}), kEnough);
  EXPECT_EQ(JudgeSpace({.free_bytes = 0, .free_min = 0, .before = kStopped}), kEnough);
}

TEST(SpaceJudgeTest, UnlessItIsSetATwentiethOfTheDiskOrAGibibyte) {
  constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;
  EXPECT_EQ(FreeMinOf(0, 10'000), 500U);
  EXPECT_EQ(FreeMinOf(0, 20 * kGiB), 20 * kGiB / 100 * 5);
  EXPECT_EQ(FreeMinOf(0, 21 * kGiB), kGiB);
  EXPECT_EQ(FreeMinOf(3 * kGiB, 21 * kGiB), 3 * kGiB);
}

TEST(SpaceJudgeTest, NeverAsksForMoreThanHalfOfTheDisk) {
  EXPECT_EQ(FreeMinOf(501, 1000), 500U);
  EXPECT_EQ(FreeMinOf(499, 1000), 499U);
}

}  // namespace
}  // namespace uplink::store
