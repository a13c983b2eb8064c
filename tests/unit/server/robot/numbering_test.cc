#include "server/robot/numbering.h"

#include <gtest/gtest.h>

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

TEST(NumberingTest, ANumberAtOrBelowTheHighestSeenIsADuplicate) {
  Numbering numbers;
  numbers.AddSettled(5);
  EXPECT_EQ(numbers.See(5).as, SeenAs::kDuplicate);
  EXPECT_EQ(numbers.See(1).as, SeenAs::kDuplicate);
  EXPECT_EQ(numbers.See(6).as, SeenAs::kNew);
}

TEST(NumberingTest, ADuplicateSaysWhetherItsFirstCopyWaits) {
  Numbering numbers;
  EXPECT_EQ(numbers.AddWaiting(1), 1U);
  EXPECT_TRUE(numbers.See(1).waits);
  EXPECT_EQ(numbers.Settle(1, 1), 1U);
  EXPECT_FALSE(numbers.See(1).waits);
}

TEST(NumberingTest, WhatIsSkippedIsNamedAndCounted) {
  Numbering numbers;
  const Seen seen = numbers.See(4);
  EXPECT_EQ(seen.missing_first, 1U);
  EXPECT_EQ(seen.missing_last, 3U);
  EXPECT_EQ(numbers.missing(), 0U) << "a look counts nothing";
  numbers.AddMissing(3);
  EXPECT_EQ(numbers.missing(), 3U);
}

TEST(NumberingTest, AJumpAtItsBoundCountsWhole) {
  Numbering numbers;
  const Seen seen = numbers.See(kMissingPerJumpMax + 1);
  EXPECT_EQ(seen.missing_last, kMissingPerJumpMax);
  EXPECT_EQ(seen.missing, kMissingPerJumpMax);
}

TEST(NumberingTest, AJumpPastItsBoundCountsItsBoundAndIsNamedWhole) {
  Numbering numbers;
  const Seen seen = numbers.See(kMissingPerJumpMax + 2);
  EXPECT_EQ(seen.missing_first, 1U);
  EXPECT_EQ(seen.missing_last, kMissingPerJumpMax + 1);
  EXPECT_EQ(seen.missing, kMissingPerJumpMax);
  numbers.AddSettled(kMissingPerJumpMax + 2);
  EXPECT_EQ(numbers.See(model::kSeqMax).missing, kMissingPerJumpMax)
      << "each jump has its own bound";
}

TEST(NumberingTest, NothingUpToWhatTheAgentSaysWasJudgedIsMissing) {
  Numbering numbers;
  EXPECT_EQ(numbers.Resume(2, 6, 0), 2U);
  EXPECT_EQ(numbers.See(7).missing_first, 0U);
  EXPECT_EQ(numbers.missing(), 0U);
  EXPECT_EQ(numbers.judged(), 6U);
}

TEST(NumberingTest, SettlingANumberThatDoesNotWaitChangesNothing) {
  Numbering numbers;
  EXPECT_EQ(numbers.AddWaiting(3), 1U);
  EXPECT_EQ(numbers.Settle(2, 2), 0U);
  EXPECT_EQ(numbers.waiting(), 1U);
  EXPECT_EQ(numbers.through(), 0U);
}

TEST(NumberingTest, AStreamGoesOnAtTheHighestNumberThatAnyoneKnows) {
  Numbering numbers;
  EXPECT_EQ(numbers.Resume(3, 3, 9), 9U) << "the store's";
  numbers.AddSettled(12);
  EXPECT_EQ(numbers.Resume(3, 3, 0), 12U) << "this process's own";
  EXPECT_EQ(numbers.Resume(20, 20, 9), 20U) << "the agent's";
}

TEST(NumberingTest, WhatThisProcessSawBeforeAnyWelcomeDoesNotCount) {
  Numbering numbers;
  numbers.AddSettled(12);
  EXPECT_EQ(numbers.Resume(3, 3, 0), 3U);
}

}  // namespace
}  // namespace uplink::robot
