// How a session goes on over streams and processes: what Welcome says, and which numbers are new,
// duplicate or missing.
#include "tests/support/fake_reader.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ResumeTest : public SessionTest {
 protected:
  /// A stream that sent these and broke.
  void SendAndBreak(const std::vector<Message>& messages) {
    BenchStream& stream = server().Connect(SessionOf(1));
    stream.Send(BatchFrame(messages));
    stream.Break();
  }
  /// The skipped ranges that the store lists, as `first-last`.
  std::vector<std::string> Gaps() {
    testing::FakeReader reader(database_);
    const auto page = reader.Gaps({.page_size = 100});
    std::vector<std::string> gaps;
    if (!page.ok()) return {"no answer"};
    for (const storage::GapRow& row : page->rows) {
      gaps.push_back(std::to_string(row.first) + "-" + std::to_string(row.last));
    }
    return gaps;
  }
};

TEST_F(ResumeTest, SameProcessKnowsItsOwnThrough) {
  SendAndBreak({{1, Fault()}, {2, Motion()}});
  server().Commit();
  BenchStream& stream = server().Connect(SessionOf(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 2", "ack 2 judged 2"));
}

TEST_F(ResumeTest, SameProcessResumesWhileTheStoreIsAway) {
  SendAndBreak({{1, Fault()}});
  server().Commit();
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  // The store may have gone back meanwhile: the agent keeps 1 until the store has said what it has.
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 1"));
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 1 judged 1"));
}

TEST_F(ResumeTest, WhatWaitsIsNotCommittedYet) {
  server().StoreAway();
  BenchStream& first = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  first.Send(BatchFrame({{1, Motion()}, {2, Fault()}, {3, Motion()}}));
  first.Break();
  BenchStream& second = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  EXPECT_THAT(second.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 3"));
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(second.TakeLines(), ElementsAre("ack 3 judged 3"));
}

TEST_F(ResumeTest, AfterARestartTheStoredCursorCounts) {
  SendAndBreak({{1, Fault()}, {2, Fault()}, {3, Motion()}});
  server().Commit();
  Start();
  BenchStream& stream = server().Connect(SessionOf(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 2", "ack 2 judged 2"));
}

TEST_F(ResumeTest, AfterARestartJudgedIsNotBelowWhatTheAgentKnows) {
  SendAndBreak({{1, Fault()}, {2, Motion()}});
  server().Commit();
  Start();
  BenchStream& stream = server().Connect(SessionOf(1), 1, 2);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 2"));
}

TEST_F(ResumeTest, ALateCursorDoesNotCount) {
  SendAndBreak(Messages(1, 3, Fault()));
  server().Commit();
  Start().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1), 1, 3);
  server().Pass(kWelcomeWait);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 3"));
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), IsEmpty()) << "the cursor came too late for this stream";
  stream.Send(BatchFrame({{2, Fault()}, {3, Fault()}}));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 3 judged 3"));
  EXPECT_EQ(server().counts().duplicate, 2U) << "the store knew them";
  EXPECT_EQ(server().counts().stored, 0U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3));
}

TEST_F(ResumeTest, SettledAboveWhatIsKnownIsBelieved) {
  BenchStream& stream = server().Connect(SessionOf(1), 20, 25);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 20", "ack 20 judged 25"));
}

TEST_F(ResumeTest, NumbersUpToJudgedAreNotMissing) {
  BenchStream& stream = server().Connect(SessionOf(1), 2, 10);
  stream.Send(BatchFrame({{11, Motion()}}));
  EXPECT_EQ(server().counts().missing, 0U);
  stream.Send(BatchFrame({{14, Motion()}}));
  EXPECT_EQ(server().counts().missing, 2U);
}

TEST_F(ResumeTest, NumbersAboveJudgedAreMissing) {
  BenchStream& stream = server().Connect(SessionOf(1), 2, 10);
  stream.Send(BatchFrame({{13, Motion()}}));
  EXPECT_EQ(server().counts().missing, 2U);
  server().Commit();
  EXPECT_THAT(Gaps(), ElementsAre("11-12"));
}

TEST_F(ResumeTest, DurableBetweenCommittedAndJudgedIsNewAfterARestart) {
  SendAndBreak({{1, Fault()}});
  server().Commit();
  BenchStream& lost = server().Connect(SessionOf(1), 1, 1);
  lost.Send(BatchFrame({{2, Fault()}, {3, Motion()}, {4, Fault()}}));
  Start();
  BenchStream& stream = server().Connect(SessionOf(1), 1, 4);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 4"));
  stream.Send(BatchFrame({{2, Fault()}, {4, Fault()}}));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 4 judged 4"));
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 4));
  EXPECT_EQ(server().counts().stored, 2U);
  EXPECT_EQ(server().counts().missing, 0U) << "3 was judged before";
}

/// More Rejects than memory keeps, committed but not confirmed, and then a store that does not
/// answer.
class LateResumeTest : public ResumeTest {
 protected:
  static constexpr model::Seq kRejects = robot::kRejectsRememberedMax + 3;

  /// Streams until the store is away.
  LateResumeTest() {
    limits_.session.batch_uplinks_max = kRejects;
    limits_.session.open_rejects_max = kRejects;
    BenchStream& stream = server().Connect(SessionOf(1));
    stream.Send(BatchFrame(Messages(1, kRejects, BadFault())));
    server().Commit();
    stream.Break();
    server().StoreAway();
  }
  BenchStream& WelcomedLate(model::Seq settled = 0) {
    BenchStream& stream = server().Connect(SessionOf(1), settled, settled);
    server().Pass(kWelcomeWait);
    return stream;
  }
};

TEST_F(LateResumeTest, NoAckCoversARejectThatMemoryLetGo) {
  BenchStream& stream = WelcomedLate();
  const std::vector<std::string> said = stream.TakeLines();
  ASSERT_EQ(said.size(), robot::kRejectsRememberedMax + 2);
  EXPECT_EQ(said.front(), "welcome 0");
  EXPECT_EQ(said[1], "reject 4 missing_field faultId");
  EXPECT_EQ(said.back(), "ack 0 judged 259");
  stream.Send(BatchFrame({{kRejects + 1, Motion()}}));
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 0 judged 260"));
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("reject 1 missing_field faultId", "reject 2 missing_field faultId",
                          "reject 3 missing_field faultId", "ack 260 judged 260"));
}

TEST_F(LateResumeTest, WhatTheAgentConfirmedNeedNotBeTold) {
  BenchStream& stream = WelcomedLate(3);
  EXPECT_EQ(stream.TakeLines().back(), "ack 3 judged 259");
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 259 judged 259"));
}

TEST_F(LateResumeTest, OneThatTheAgentDidNotConfirmHoldsAcksBack) {
  BenchStream& stream = WelcomedLate(2);
  EXPECT_EQ(stream.TakeLines().back(), "ack 2 judged 259");
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("reject 3 missing_field faultId", "ack 259 judged 259"));
}

TEST_F(LateResumeTest, AHalfClosedStreamEndsOnceTheyAreTold) {
  BenchStream& stream = WelcomedLate();
  stream.HalfClose();
  EXPECT_EQ(stream.end(), "");
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 259 judged 259");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(LateResumeTest, AHalfClosedStreamIsNotToldThatAllIsSettledWhileTheStoreIsAway) {
  BenchStream& stream = WelcomedLate();
  stream.HalfClose();
  server().Pass(limits_.session.drain_timeout);
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
  EXPECT_EQ(stream.TakeLines().back(), "ack 0 judged 259");
}

TEST_F(LateResumeTest, ANewerStreamIsToldThemInsteadOfTheOlder) {
  BenchStream& older = WelcomedLate();
  static_cast<void>(older.TakeLines());
  BenchStream& newer = WelcomedLate(1);
  EXPECT_EQ(newer.TakeLines().back(), "ack 1 judged 259");
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(newer.TakeLines(),
              ElementsAre("reject 2 missing_field faultId", "reject 3 missing_field faultId",
                          "ack 259 judged 259"));
  EXPECT_THAT(older.TakeLines(), IsEmpty());
}

TEST_F(ResumeTest, AJumpIsListedWholeAndCountedUpToItsBound) {
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Motion()}, {1 + kSeqJumpMax, Motion()}}));
  server().Commit();
  EXPECT_EQ(server().counts().missing, robot::kMissingPerJumpMax);
  EXPECT_EQ(server().robot().sessions.View().missing, robot::kMissingPerJumpMax);
  EXPECT_THAT(Gaps(), ElementsAre("2-4294967296"));
}

TEST_F(ResumeTest, GapsAreCountedAndListed) {
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Fault()}, {2, Fault()}, {5, Fault()}, {6, Motion()}, {8, Motion()}}));
  server().Commit();
  EXPECT_EQ(server().counts().missing, 3U);
  EXPECT_THAT(Gaps(), ::testing::UnorderedElementsAre("3-4", "7-7"));
  EXPECT_EQ(server().robot().sessions.View().missing, 3U);
  EXPECT_EQ(server().robot().sessions.in_flight(), 0U);
}

TEST_F(ResumeTest, ASessionThatDoesNotBeginAtOneHasAGap) {
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Send(BatchFrame({{4, Fault()}}));
  server().Commit();
  EXPECT_THAT(Gaps(), ElementsAre("1-3"));
}

TEST_F(ResumeTest, ADuplicateThatWaitsIsAnsweredByItsCopysAck) {
  BenchStream& first = server().Connect(SessionOf(1));
  first.Send(BatchFrame({{1, Fault()}}));
  first.Break();
  BenchStream& second = server().Connect(SessionOf(1));
  EXPECT_THAT(second.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 1"));
  second.Send(BatchFrame({{1, Fault()}}));
  EXPECT_EQ(server().counts().duplicate, 1U) << "counted at once";
  EXPECT_THAT(second.TakeLines(), IsEmpty());
  server().Commit();
  EXPECT_THAT(second.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_EQ(server().counts().stored, 1U);
}

TEST_F(ResumeTest, ASettledDuplicateIsAnsweredByAnAckAtOnce) {
  SendAndBreak({{1, Fault()}});
  server().Commit();
  BenchStream& stream = server().Connect(SessionOf(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 1"));
  stream.Send(BatchFrame({{1, Fault()}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_EQ(server().counts().duplicate, 1U);
}

TEST_F(ResumeTest, ALiveDuplicateIsNotAppliedAgain) {
  SendAndBreak({{1, Motion(47)}, {2, Fault()}});
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Send(BatchFrame({{1, Motion(10)}}));
  const auto parts = server().robot().state.Snapshot(robot::RobotState::Parts::kAll).parts;
  EXPECT_EQ(parts.motion->pose->lat_deg, 47);
  EXPECT_EQ(server().counts().duplicate, 1U);
}

TEST_F(ResumeTest, AnOlderSessionCommitsToItsOwnCursor) {
  BenchStream& older = server().Connect(SessionOf(1));
  older.Send(BatchFrame(Messages(1, 3, Fault())));
  older.Break();
  BenchStream& newer = server().Connect(SessionOf(2));
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  newer.Send(BatchFrame({{1, Fault()}}));
  server().Commit();
  EXPECT_THAT(newer.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_EQ(database_.Cursor(kRobot, SessionOf(1)), 3U);
  EXPECT_EQ(database_.Cursor(kRobot, SessionOf(2)), 1U);
}

TEST_F(ResumeTest, ALostCommitAnswerStoresNothingTwice) {
  BenchStream& stream = server().Connect(SessionOf(1));
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame(Messages(1, 2, Fault())));
  server().store().FailNextCommits(1, testing::FailAt::kAfter);
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), IsEmpty()) << "not known yet to be durable";
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 2 judged 2"));
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
}

TEST_F(ResumeTest, AnIdleSessionIsForgotten) {
  SendAndBreak({{1, Motion()}});
  server().Pass(limits_.session.session_idle);
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_EQ(server().robot().sessions.Held().size(), 1U);
  server().Pass(milliseconds(1));
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_THAT(server().robot().sessions.Held(), IsEmpty());
  server().Commit();  // a sweep of the store is due first
  BenchStream& stream = server().Connect(SessionOf(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

}  // namespace
}  // namespace uplink::session
