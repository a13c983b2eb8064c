#include "server/robot/ack_window.h"

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

TEST(AckWindowTest, BeginsSettledUpToWhereItStarts) {
  const AckWindow window(7);
  EXPECT_EQ(window.seen(), 7U);
  EXPECT_EQ(window.through(), 7U);
  EXPECT_EQ(window.waiting(), 0U);
}

TEST(AckWindowTest, SettledNumbersMoveThrough) {
  AckWindow window;
  window.AddSettled(1);
  window.AddSettled(5);
  EXPECT_EQ(window.seen(), 5U);
  EXPECT_EQ(window.through(), 5U);
}

TEST(AckWindowTest, AWaitingNumberHoldsThroughAtTheHighestSeenBelowIt) {
  AckWindow window;
  window.AddSettled(3);
  window.AddWaiting(9);
  window.AddSettled(10);
  EXPECT_EQ(window.seen(), 10U);
  EXPECT_EQ(window.through(), 3U) << "4 to 8 were never seen";
  EXPECT_TRUE(window.Settle(9, 9));
  EXPECT_EQ(window.through(), 10U);
}

TEST(AckWindowTest, SettlingOutOfOrderMovesThroughOnlyFromBelow) {
  AckWindow window;
  window.AddWaiting(1);
  window.AddWaiting(2);
  window.AddWaiting(4);
  EXPECT_TRUE(window.Settle(2, 2));
  EXPECT_EQ(window.through(), 0U);
  EXPECT_TRUE(window.Settle(1, 1));
  EXPECT_EQ(window.through(), 2U);
  EXPECT_TRUE(window.Settle(4, 4));
  EXPECT_EQ(window.through(), 4U);
  EXPECT_EQ(window.waiting(), 0U);
}

TEST(AckWindowTest, ARangeIsSettledAsAWholeAndNothingBesideIt) {
  AckWindow window;
  for (const model::Seq seq : {1U, 2U, 3U, 4U, 5U}) window.AddWaiting(seq);
  EXPECT_TRUE(window.Settle(2, 4));
  EXPECT_EQ(window.waiting(), 2U);
  EXPECT_EQ(window.through(), 0U);
  EXPECT_FALSE(window.Settle(2, 4));
  EXPECT_TRUE(window.Settle(1, 1));
  EXPECT_EQ(window.through(), 4U);
  EXPECT_TRUE(window.Settle(5, 5));
  EXPECT_EQ(window.through(), 5U);
}

TEST(AckWindowTest, SettlingWhatDoesNotWaitChangesNothing) {
  AckWindow window;
  window.AddSettled(1);
  window.AddWaiting(3);
  EXPECT_FALSE(window.Settle(1, 1));
  EXPECT_FALSE(window.Settle(2, 2));
  EXPECT_FALSE(window.Settle(4, 4));
  EXPECT_EQ(window.waiting(), 1U);
  EXPECT_TRUE(window.Settle(3, 3));
  EXPECT_FALSE(window.Settle(3, 3));
}

TEST(AckWindowTest, KnowsWhatWaits) {
  AckWindow window;
  window.AddWaiting(2);
  window.AddWaiting(6);
  EXPECT_FALSE(window.Waits(1));
  EXPECT_TRUE(window.Waits(2));
  EXPECT_FALSE(window.Waits(4));
  EXPECT_TRUE(window.Waits(6));
  EXPECT_FALSE(window.Waits(7));
}

TEST(AckWindowTest, RaiseCountsAsSeenAndSettled) {
  AckWindow window;
  window.Raise(8);
  EXPECT_EQ(window.seen(), 8U);
  EXPECT_EQ(window.through(), 8U);
  window.Raise(4);
  EXPECT_EQ(window.seen(), 8U);
}

TEST(AckWindowTest, RaiseLeavesWhatWaitsWaiting) {
  AckWindow window;
  window.AddSettled(1);
  window.AddWaiting(2);
  window.Raise(9);
  EXPECT_EQ(window.through(), 1U);
  EXPECT_TRUE(window.Waits(2));
  window.AddWaiting(10);
  EXPECT_TRUE(window.Settle(2, 2));
  EXPECT_EQ(window.through(), 9U);
}

TEST(AckWindowTest, HoldsTheHighestNumber) {
  AckWindow window;
  window.AddWaiting(model::kSeqMax);
  EXPECT_EQ(window.through(), 0U);
  EXPECT_TRUE(window.Settle(model::kSeqMax, model::kSeqMax));
  EXPECT_EQ(window.through(), model::kSeqMax);
}

TEST(AckWindowDeathTest, ANumberAtOrBelowTheHighestSeenIsOurBug) {
  AckWindow window(5);
  EXPECT_DEATH(window.AddSettled(5), "above all seen");
  EXPECT_DEATH(window.AddWaiting(5), "above all seen");
}

}  // namespace
}  // namespace uplink::robot
