// Two processes on one database: the one that lost a robot lets it go.
#include "server/journal/writer_context.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FencingTest : public SessionTest {
 protected:
  FencingTest() : mine_(server()), other_(clock_, database_, 99, limits_) {}

  BenchServer& mine_;
  BenchServer other_;
};

TEST_F(FencingTest, ARefusedCommitEndsTheStreamAsSuperseded) {
  BenchStream& stream = mine_.Connect(SessionOf(1));
  static_cast<void>(stream.TakeLines());
  other_.Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Fault()}, {2, BadFault()}, {3, Motion()}}));
  mine_.Commit();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 2 missing_field faultId"))
      << "no Ack for them";
  EXPECT_EQ(mine_.counts().superseded, 2U);
  EXPECT_EQ(mine_.counts().applied, 1U);
  EXPECT_EQ(mine_.counts().in_flight, 0);
  EXPECT_THAT(Stored(1), IsEmpty());
  EXPECT_THAT(mine_.robot().sessions.Held(), IsEmpty());
}

TEST_F(FencingTest, OnlyTheRobotThatWasTakenIsLetGo) {
  BenchStream& processed = mine_.Connect(SessionOf(1));
  BenchStream& kept = mine_.Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  other_.Connect(SessionOf(1));
  processed.Send(BatchFrame({{1, Fault()}}));
  kept.Send(BatchFrame({{1, Fault()}}));
  mine_.Commit();
  EXPECT_EQ(processed.end(), "ABORTED: superseded");
  EXPECT_EQ(kept.end(), "");
  EXPECT_EQ(kept.TakeLines().back(), "ack 1 judged 1");
}

TEST_F(FencingTest, RecordsBehindTheRefusedOnesAreDroppedUnwritten) {
  limits_.journal.batch_records_max = 1;
  BenchServer& mine = Start();
  BenchStream& stream = mine.Connect(SessionOf(1));
  other_.Connect(SessionOf(1));
  stream.Send(BatchFrame(Messages(1, 5, Fault())));
  mine.Commit();
  EXPECT_EQ(mine.counts().superseded, 5U);
  EXPECT_EQ(mine.journal().records(), 0U);
  EXPECT_THAT(Stored(1), IsEmpty());
}

TEST_F(FencingTest, WhatIsTakenBeforeTheStreamLearnsOfItIsVoid) {
  BenchStream& stream = mine_.Connect(SessionOf(1));
  other_.Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Fault()}}));
  while (mine_.Advance() == journal::Step::kWorked) {
  }
  stream.Send(BatchFrame({{2, Fault()}, {3, Motion()}}));
  EXPECT_EQ(mine_.counts().received, 1U);
  mine_.Commit();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
  EXPECT_THAT(Stored(1), IsEmpty());
}

TEST_F(FencingTest, AnOpenThatFindsAnotherHolderEndsTheStream) {
  BenchStream& first = mine_.Connect(SessionOf(1));
  first.Send(BatchFrame({{1, Fault()}}));
  first.Break();
  other_.Connect(SessionOf(2));
  BenchStream& second = mine_.Connect(SessionOf(1));
  EXPECT_EQ(second.end(), "ABORTED: superseded");
  EXPECT_EQ(mine_.counts().superseded, 1U);
  mine_.Commit();
  EXPECT_THAT(Stored(1), IsEmpty()) << "what waited is void";
  BenchStream& third = mine_.Connect(SessionOf(1));
  EXPECT_THAT(third.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  third.Send(BatchFrame({{1, Fault()}}));
  mine_.Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1));
}

TEST_F(FencingTest, TheRobotCanComeBack) {
  BenchStream& stream = mine_.Connect(SessionOf(1));
  BenchStream& elsewhere = other_.Connect(SessionOf(1));
  elsewhere.Send(BatchFrame({{1, Fault()}, {2, Fault()}}));
  other_.Commit();
  stream.Send(BatchFrame({{1, Fault()}}));
  mine_.Commit();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
  BenchStream& back = mine_.Connect(SessionOf(1), 0, 1);
  EXPECT_THAT(back.TakeLines(), ElementsAre("welcome 2", "ack 2 judged 2"));
  back.Send(BatchFrame({{3, Fault()}}));
  mine_.Commit();
  EXPECT_EQ(back.TakeLines().back(), "ack 3 judged 3");
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3));
}

TEST_F(FencingTest, ARobotWhoseRowWentComesBackByItselfAndNothingIsLost) {
  BenchStream& stream = mine_.Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Fault()}}));
  mine_.Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 1 judged 1");
  database_.DeleteRobotRow(kRobot);
  stream.Send(BatchFrame({{2, Fault()}, {5, BadFault()}, {6, Motion()}}));
  mine_.Commit();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
  EXPECT_THAT(Stored(1), ElementsAre(1));
  EXPECT_EQ(database_.EpochOf(kRobot), 0U) << "a batch makes no robot";
  EXPECT_EQ(mine_.counts().superseded, 2U);
  EXPECT_EQ(mine_.counts().in_flight, 0);
  // What was not acked is sent again, as after any end of a stream.
  BenchStream& back = mine_.Connect(SessionOf(1), 1, 1);
  EXPECT_THAT(back.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 1"));
  back.Send(BatchFrame({{2, Fault()}, {5, BadFault()}}));
  mine_.Commit();
  EXPECT_THAT(back.TakeLines(), ElementsAre("reject 5 missing_field faultId", "ack 5 judged 5"));
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
  EXPECT_EQ(mine_.counts().stored, 2U);
}

TEST_F(FencingTest, AHalfClosedStreamDoesNotEndOkWithoutItsRecords) {
  BenchStream& stream = mine_.Connect(SessionOf(1));
  stream.StopReading();
  stream.Send(BatchFrame(Messages(1, 64, Motion())));
  other_.Connect(SessionOf(1));
  stream.Send(BatchFrame({{65, Fault()}}));
  stream.HalfClose();
  while (mine_.Advance() == journal::Step::kWorked) {
  }
  stream.ReadAgain();
  EXPECT_EQ(stream.end(), "") << "65 was never settled";
  mine_.DeliverWakes();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
}

TEST_F(FencingTest, GapsThatBecomeVoidLetTheNextStreamFlow) {
  limits_.session.in_flight_uplinks_max = 2;
  BenchServer& mine = Start();
  BenchStream& first = mine.Connect(SessionOf(1));
  first.Send(BatchFrame({{10, Motion()}, {20, Motion()}, {30, Motion()}}));
  EXPECT_FALSE(first.reading()) << "two gaps wait";
  first.Break();
  other_.Connect(SessionOf(1));
  EXPECT_EQ(mine.Connect(SessionOf(1)).end(), "ABORTED: superseded");
  BenchStream& third = mine.Connect(SessionOf(1));
  mine.Commit();
  EXPECT_THAT(third.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_TRUE(third.reading());
  EXPECT_EQ(mine.robot().sessions.in_flight(), 0U);
}

}  // namespace
}  // namespace uplink::session
