// Rejects of quarantine that are read by pages after the Welcome, and what Acks may say meanwhile.
#include "server/session/reject_pages.h"

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string Bad(model::Seq seq) {
  return "reject " + std::to_string(seq) + " missing_field faultId";
}

/// Seven Rejects lie in quarantine, and a new process knows of none; two come with each answer of
/// the store.
class RejectPagesTest : public SessionTest {
 protected:
  RejectPagesTest() {
    limits_.session.open_rejects_max = 2;
    limits_.session.reject_page_max = 2;
    BenchStream& stream = server().Connect(SessionOf(1));
    stream.Send(BatchFrame(Messages(1, 7, BadFault())));
    server().Commit();
    Start();
  }
  BenchStream& Welcomed(model::Seq settled = 0) {
    return server().Connect(SessionOf(1), settled, settled);
  }
};

TEST_F(RejectPagesTest, AreToldPageByPageAndAckedSoFar) {
  BenchStream& stream = Welcomed();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 7", Bad(1), Bad(2), "ack 2 judged 2"));
  EXPECT_TRUE(stream.reading());
  EXPECT_TRUE(server().ReadRejects());
  EXPECT_THAT(stream.TakeLines(), ElementsAre(Bad(3), Bad(4), "ack 4 judged 4"));
  EXPECT_TRUE(server().ReadRejects());
  EXPECT_THAT(stream.TakeLines(), ElementsAre(Bad(5), Bad(6), "ack 6 judged 6"));
  EXPECT_TRUE(server().ReadRejects());
  EXPECT_THAT(stream.TakeLines(), ElementsAre(Bad(7), "ack 7 judged 7"));
  EXPECT_FALSE(server().ReadRejects());
  EXPECT_EQ(server().probe().reject_pages_total.value(), 3);
}

TEST_F(RejectPagesTest, AFullLastPageIsFollowedByAnEmptyOne) {
  BenchStream& stream = Welcomed(1);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 7", Bad(2), Bad(3), "ack 3 judged 3"));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre(Bad(4), Bad(5), "ack 5 judged 5", Bad(6), Bad(7), "ack 7 judged 7"));
}

TEST_F(RejectPagesTest, WhatComesWithTheAnswerAloneIsReadByNobody) {
  BenchStream& stream = Welcomed(5);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 7", Bad(6), Bad(7), "ack 7 judged 7"));
  EXPECT_EQ(server().rejects().waiting(), 0U);
}

TEST_F(RejectPagesTest, NoAckOfOtherMessagesCoversOneThatIsUnread) {
  BenchStream& stream = Welcomed();
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame({{8, Motion()}, {9, Fault()}}));
  while (server().Advance() == journal::Step::kWorked) server().DeliverWakes();
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 2 judged 2"));
  EXPECT_THAT(Stored(1), ElementsAre(9));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 9 judged 9");
}

TEST_F(RejectPagesTest, AnAgentThatKnowsWhatWasJudgedIsToldThatNewOnesAre) {
  BenchStream& stream = server().Connect(SessionOf(1), 0, 7);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 7", Bad(1), Bad(2), "ack 2 judged 7"));
  stream.Send(BatchFrame({{8, Motion()}}));
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 2 judged 8"));
}

TEST_F(RejectPagesTest, ANewProcessWithoutTheStoreCoversNoneThatAnotherMayHaveRejected) {
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1), 2, 7);
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame({{8, Motion()}}));
  server().Pass(limits_.session.ack_interval);
  for (const std::string& said : stream.TakeLines()) {
    EXPECT_TRUE(!said.starts_with("ack ") || said.starts_with("ack 2 ")) << said;
  }
  server().StoreBack();
  server().Commit();
  const std::vector<std::string> said = stream.TakeLines();
  for (model::Seq seq = 3; seq <= 7; ++seq) EXPECT_THAT(said, ::testing::Contains(Bad(seq)));
  EXPECT_EQ(said.back(), "ack 8 judged 8");
}

TEST_F(RejectPagesTest, ANewRejectIsToldAtOnce) {
  BenchStream& stream = Welcomed();
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame({{8, BadFault()}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre(Bad(8)));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 8 judged 8");
}

TEST_F(RejectPagesTest, TheNextPageIsAskedForOnceTheOneBeforeIsWritten) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  EXPECT_TRUE(server().ReadRejects());
  EXPECT_EQ(server().rejects().waiting(), 0U) << "the agent has not read the first";
  stream.ReadOne();
  EXPECT_EQ(server().rejects().waiting(), 1U);
  stream.ReadAgain();
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 7 judged 7");
}

TEST_F(RejectPagesTest, AReadThatFailsIsTriedAgainAfterASecond) {
  BenchStream& stream = Welcomed();
  static_cast<void>(stream.TakeLines());
  server().rejects().SetAway(true);
  EXPECT_TRUE(server().ReadRejects());
  EXPECT_EQ(server().rejects().waiting(), 0U);
  EXPECT_EQ(server().probe().reject_reads_failed_total.value(), 1);
  server().Pass(kRejectsReadAgain - milliseconds(1));
  EXPECT_EQ(server().rejects().waiting(), 0U);
  server().Pass(milliseconds(1));
  EXPECT_EQ(server().rejects().waiting(), 1U);
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  server().rejects().SetAway(false);
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 7 judged 7");
}

TEST_F(RejectPagesTest, AReadThatIsNotTakenIsTriedAgainAfterASecond) {
  server().rejects().SetFull(true);
  BenchStream& stream = Welcomed();
  EXPECT_EQ(server().rejects().waiting(), 0U);
  server().rejects().SetFull(false);
  server().Pass(kRejectsReadAgain);
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 7 judged 7");
}

TEST_F(RejectPagesTest, ATryThatIsDueWaitsForThePeerWithoutATimer) {
  BenchStream& stream = Welcomed();
  server().rejects().SetAway(true);
  EXPECT_TRUE(server().ReadRejects());
  stream.StopReading();
  stream.Send(BatchFrame({{8, BadFault()}, {9, BadFault()}}));
  server().Pass(kRejectsReadAgain);
  EXPECT_EQ(server().rejects().waiting(), 0U);
  const std::optional<SteadyTime> deadline = stream.session().deadline();
  EXPECT_TRUE(!deadline || *deadline > clock_.Steady());
  server().rejects().SetAway(false);
  stream.ReadAgain();
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 9 judged 9");
}

TEST_F(RejectPagesTest, ANewerStreamReadsItsOwnPages) {
  BenchStream& older = Welcomed();
  EXPECT_EQ(server().rejects().waiting(), 1U);
  BenchStream& newer = Welcomed(2);
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 7", Bad(3), Bad(4), "ack 4 judged 4"));
  EXPECT_TRUE(server().ReadRejects()) << "the older one's";
  EXPECT_THAT(newer.TakeLines(), IsEmpty());
  server().Commit();
  EXPECT_THAT(newer.TakeLines(),
              ElementsAre(Bad(5), Bad(6), "ack 6 judged 6", Bad(7), "ack 7 judged 7"));
}

TEST_F(RejectPagesTest, AStreamThatBreaksMeanwhileLeavesThemToTheNext) {
  Welcomed().Break();
  EXPECT_TRUE(server().ReadRejects());
  BenchStream& next = Welcomed();
  server().Commit();
  const std::vector<std::string> said = next.TakeLines();
  EXPECT_EQ(said.back(), "ack 7 judged 7");
  for (model::Seq seq = 1; seq <= 7; ++seq) {
    EXPECT_THAT(said, ::testing::Contains(Bad(seq))) << seq;
  }
}

TEST_F(RejectPagesTest, TheNextWelcomeWithoutTheStoresAnswerAwaitsThem) {
  Welcomed().Break();
  server().StoreAway();
  BenchStream& next = Welcomed();
  server().Pass(kWelcomeWait);
  EXPECT_EQ(next.TakeLines().back(), "ack 0 judged 7");
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(next.TakeLines().back(), "ack 7 judged 7");
}

TEST_F(RejectPagesTest, AHalfClosedStreamEndsOnceAllAreTold) {
  BenchStream& stream = Welcomed();
  stream.HalfClose();
  EXPECT_EQ(stream.end(), "");
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 7 judged 7");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(RejectPagesTest, AnotherProcessThatTakesTheRobotEndsIt) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{8, Fault()}}));
  BenchServer other(clock_, database_, 77, limits_);
  static_cast<void>(other.Connect(SessionOf(1)));
  server().Commit();
  EXPECT_EQ(stream.end(), "ABORTED: superseded");
  EXPECT_THAT(stream.TakeLines(), ::testing::Not(::testing::Contains("ack 7 judged 7")));
}

}  // namespace
}  // namespace uplink::session
