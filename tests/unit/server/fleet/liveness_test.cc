#include "server/fleet/liveness.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

class LivenessTest : public ::testing::Test {
 protected:
  testing::ManualClock clock_;
  metrics::Cell streams_total_;
  Liveness liveness_{clock_, streams_total_};
};

TEST_F(LivenessTest, LivesForAMinuteWithoutASign) {
  clock_.Advance(kAliveMax);
  EXPECT_TRUE(liveness_.alive());
  clock_.Advance(milliseconds(1));
  EXPECT_FALSE(liveness_.alive());
}

TEST_F(LivenessTest, AHandshakeBringsItBack) {
  clock_.Advance(kAliveMax * 2);
  EXPECT_FALSE(liveness_.alive());
  liveness_.NoteHandshake();
  EXPECT_TRUE(liveness_.alive());
  EXPECT_EQ(liveness_.age(), milliseconds(0));
}

TEST_F(LivenessTest, ASlowStartTakesNothingFromItsMinute) {
  clock_.Advance(kAliveMax * 2);
  liveness_.BeginListening();
  EXPECT_TRUE(liveness_.alive());
  clock_.Advance(kAliveMax);
  EXPECT_TRUE(liveness_.alive());
  clock_.Advance(milliseconds(1));
  EXPECT_FALSE(liveness_.alive());
}

TEST_F(LivenessTest, AStreamThatOpensCountsOnce) {
  clock_.Advance(kAliveMax * 2);
  streams_total_.Add();
  EXPECT_TRUE(liveness_.alive());
  clock_.Advance(kAliveMax + milliseconds(1));
  EXPECT_FALSE(liveness_.alive());
}

TEST_F(LivenessTest, IsBehindFromTheLimitUntilAnAnswerComesInTime) {
  liveness_.NoteAsked();
  clock_.Advance(kBehindAfter);
  EXPECT_FALSE(liveness_.behind());
  clock_.Advance(milliseconds(1));
  EXPECT_TRUE(liveness_.behind()) << "without an answer";
  liveness_.NoteHandshake();
  EXPECT_TRUE(liveness_.behind()) << "the answer was late";
  liveness_.NoteAsked();
  clock_.Advance(kCaughtUpWithin + milliseconds(1));
  liveness_.NoteHandshake();
  EXPECT_TRUE(liveness_.behind()) << "not quick enough to have caught up";
  liveness_.NoteAsked();
  clock_.Advance(kCaughtUpWithin);
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, AnAnswerAtTheLimitIsNotLate) {
  liveness_.NoteAsked();
  clock_.Advance(kBehindAfter);
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, WithoutAnAnswerItCountsFromTheFirstHandshake) {
  liveness_.NoteAsked();
  clock_.Advance(kBehindAfter);
  liveness_.NoteAsked();
  clock_.Advance(milliseconds(1));
  EXPECT_TRUE(liveness_.behind());
}

TEST_F(LivenessTest, IsBehindFromAStandstillUntilAHandshakeBegunAfterwardsIsAnsweredInTime) {
  EXPECT_EQ(liveness_.standstills(), 0);
  liveness_.NoteStandstill();
  EXPECT_TRUE(liveness_.behind());
  EXPECT_EQ(liveness_.standstills(), 1);
  clock_.Advance(std::chrono::hours(1));
  EXPECT_TRUE(liveness_.behind()) << "time alone ends nothing";
  liveness_.NoteAsked();
  clock_.Advance(kCaughtUpWithin + milliseconds(1));
  liveness_.NoteHandshake();
  EXPECT_TRUE(liveness_.behind()) << "answered, but late";
  liveness_.NoteAsked();
  clock_.Advance(kCaughtUpWithin);
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, AHandshakeThatWasUnderWayAtAStandstillProvesNothing) {
  liveness_.NoteAsked();
  liveness_.NoteStandstill();
  liveness_.NoteHandshake();
  EXPECT_TRUE(liveness_.behind()) << "answered in time, but begun before";
  EXPECT_EQ(liveness_.age(), milliseconds(0)) << "the listener lives all the same";
  liveness_.NoteAsked();
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, ARefusalFromBeforeAStandstillDoesNotMakeALaterAnswerLate) {
  liveness_.NoteAsked();  // refused
  clock_.Advance(std::chrono::minutes(1));
  liveness_.NoteStandstill();
  liveness_.NoteAsked();
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, NobodyAskedSoNobodyIsBehind) {
  clock_.Advance(kBehindAfter * 2);
  EXPECT_FALSE(liveness_.behind());
  streams_total_.Add();
  liveness_.NoteHandshake();
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(LivenessTest, CivilTimeDoesNotMatter) {
  clock_.SetSystem(FromUnixMs(0));
  EXPECT_EQ(liveness_.age(), milliseconds(0));
}

}  // namespace
}  // namespace uplink::fleet
