// When the server stops reading a stream, when it reads again, and what presence makes of it.
#include <algorithm>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class HoldBackTest : public SessionTest {
 protected:
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
  robot::SessionView Shown() { return server().robot().sessions.View(); }
  robot::Presence Swept() {
    server().fleet().Sweep(limits_.session.session_idle);
    return server().robot().state.presence();
  }
};

TEST_F(HoldBackTest, AtInFlightMaxNothingMoreIsTaken) {
  limits_.session.in_flight_uplinks_max = 4;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, Fault())));
  EXPECT_TRUE(stream.reading());
  stream.Send(BatchFrame(Messages(4, 6, Fault())));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(server().counts().received, 4U);
  EXPECT_TRUE(server().robot().state.held_back());
  EXPECT_EQ(Shown().held_back, HeldBack::kInFlight);
  EXPECT_EQ(Shown().held_back_since, clock_.System());
  EXPECT_EQ(server().probe().held_back.value(), 1);
  server().Commit();
  EXPECT_EQ(Shown().held_back, HeldBack::kNone);
  EXPECT_TRUE(stream.reading());
  EXPECT_FALSE(server().robot().state.held_back());
  EXPECT_EQ(server().probe().held_back.value(), 0);
  EXPECT_EQ(server().probe().held_back_total.value(), 1);
  constexpr auto kInFlight = static_cast<std::size_t>(HeldBack::kInFlight);
  EXPECT_EQ(server().probe().held_back_by[kInFlight].value(), 0);
  EXPECT_EQ(server().probe().held_back_by_total[kInFlight].value(), 1);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(HoldBackTest, ExactlyInFlightMaxHoldsBackTheNextDurableMessage) {
  limits_.session.in_flight_uplinks_max = 4;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 4, Fault())));
  EXPECT_TRUE(stream.reading()) << "it may be live";
  stream.Send(BatchFrame({{5, Motion()}}));
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(server().counts().applied, 1U);
  stream.Send(BatchFrame({{6, Fault()}}));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(server().counts().received, 5U);
  server().Commit();
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(server().counts().received, 6U);
}

TEST_F(HoldBackTest, LiveMessagesBehindOneThatWaitsWaitInOrder) {
  limits_.session.in_flight_uplinks_max = 1;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, Fault()}, {3, Motion()}}));
  EXPECT_EQ(server().counts().applied, 0U);
  server().Commit();
  EXPECT_EQ(server().counts().applied, 1U);
}

TEST_F(HoldBackTest, WhatWaitsOutlivesTheScratchThatStreamsShare) {
  limits_.session.in_flight_uplinks_max = 1;
  BenchStream& stream = Welcomed();
  BenchStream& other = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  stream.AtNextWrite([&other] { other.Send(BatchFrame(Messages(1, 2, Motion()))); });
  stream.Send(BatchFrame({{1, BadFault()}, {2, Fault()}}));
  EXPECT_EQ(server().counts().applied + server().counts().superseded, 2U);
  EXPECT_FALSE(stream.reading());
  server().Commit();
  EXPECT_EQ(server().counts().stored, 1U);
  EXPECT_THAT(Stored(1), ::testing::Contains(2U));
}

TEST_F(HoldBackTest, AFullJournalHoldsBackEveryStreamAtItsNextDurableMessage) {
  limits_.journal.bytes_max = 600;
  BenchStream& stream = Welcomed();
  BenchStream& other = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  stream.Send(BatchFrame({{1, Fault()}}));
  EXPECT_FALSE(server().journal().HasRoom());
  EXPECT_TRUE(stream.reading());
  other.Send(BatchFrame({{1, Motion()}, {2, Motion()}, {3, Fault()}, {4, Motion()}}));
  EXPECT_FALSE(other.reading());
  EXPECT_EQ(server().robot("rcan://bench/2").sessions.View().held_back, HeldBack::kJournal);
  EXPECT_EQ(server().counts().received, 3U) << "the live ones ahead of it are judged";
  EXPECT_EQ(other.TakeLines().back(), "ack 0 judged 0");
  server().Commit();
  EXPECT_TRUE(stream.reading());
  EXPECT_TRUE(other.reading());
  EXPECT_EQ(server().counts().received, 5U);
  server().Commit();
  EXPECT_EQ(server().counts().stored, 2U);
}

TEST_F(HoldBackTest, AFullJournalIsNoMatterToARobotThatSendsLiveKindsAlone) {
  limits_.journal.bytes_max = 600;
  BenchStream& stream = Welcomed();
  BenchStream& other = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  stream.Send(BatchFrame({{1, Fault()}}));
  for (model::Seq seq = 1; seq <= 200; ++seq) {
    other.Send(BatchFrame({{seq, Motion()}}));
    ASSERT_TRUE(other.reading()) << seq;
  }
  EXPECT_FALSE(server().robot("rcan://bench/2").state.held_back());
  EXPECT_EQ(server().counts().applied, 200U);
  EXPECT_EQ(other.TakeLines().back(), "ack 192 judged 192");
}

TEST_F(HoldBackTest, WhatIsRejectedAndWhatIsSkippedIsDurableToo) {
  limits_.journal.bytes_max = 600;
  BenchStream& stream = Welcomed();
  BenchStream& bad = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  BenchStream& skips = server().Connect(SessionOf(3), 0, 0, "rcan://bench/3");
  stream.Send(BatchFrame({{1, Fault()}}));
  static_cast<void>(bad.TakeLines());
  bad.Send(BatchFrame({{1, Motion(91)}}));
  EXPECT_FALSE(bad.reading());
  EXPECT_THAT(bad.TakeLines(), IsEmpty()) << "it is not judged yet";
  EXPECT_EQ(server().robot("rcan://bench/2").state.presence(), robot::Presence::kUnknown);
  skips.Send(BatchFrame({{1, Motion()}, {3, Motion()}}));
  EXPECT_FALSE(skips.reading());
  EXPECT_EQ(server().counts().missing, 0U);
  server().Commit();
  EXPECT_THAT(bad.TakeLines(), ElementsAre("reject 1 out_of_range pose.latDeg", "ack 1 judged 1"));
  EXPECT_EQ(server().counts().missing, 1U) << "counted once";
  EXPECT_TRUE(skips.reading());
  server().Commit();
  EXPECT_EQ(server().counts().received, 4U);
  EXPECT_EQ(server().counts().rejected, 1U);
}

TEST_F(HoldBackTest, OneRobotAtItsShareOfTheJournalHoldsBackItselfAlone) {
  limits_.journal.bytes_max = 64'000;  // a 32nd has room for three faults
  BenchStream& stream = Welcomed();
  BenchStream& other = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  stream.Send(BatchFrame(Messages(1, 50, Fault())));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(Shown().held_back, HeldBack::kJournalShare);
  const std::size_t share = server().journal().bytes();
  EXPECT_LE(share, 2'000U);
  EXPECT_GE(share, 1'000U);
  other.Send(BatchFrame({{1, Fault()}}));
  EXPECT_TRUE(other.reading());
  server().Commit();
  for (int commits = 0; commits < 50 && server().counts().stored < 51; ++commits) server().Commit();
  EXPECT_EQ(server().counts().stored, 51U) << "in shares";
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(stream.TakeLines().back(), "ack 50 judged 50");
}

TEST_F(HoldBackTest, ARobotWithNothingInTheJournalAppendsOneRecordOfAnySize) {
  limits_.journal.bytes_max = 3'200;  // a 32nd has room for no fault
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, Fault())));
  EXPECT_EQ(server().counts().received, 1U);
  EXPECT_EQ(Shown().held_back, HeldBack::kJournalShare);
  server().Commit();
  EXPECT_EQ(server().counts().stored, 3U) << "one after the other";
}

TEST_F(HoldBackTest, AStoreThatIsAwayForTenMinutesStopsTheGreedyRobotAlone) {
  limits_.journal.bytes_max = 64'000;
  BenchStream& greedy = Welcomed();
  BenchStream& other = server().Connect(SessionOf(2), 0, 0, "rcan://bench/2");
  server().StoreAway();
  greedy.Send(BatchFrame(Messages(1, 100, Fault())));
  EXPECT_EQ(Shown().held_back, HeldBack::kJournalShare);
  for (model::Seq minute = 1; minute <= 10; ++minute) {
    server().Pass(std::chrono::minutes(1));
    other.Send(BatchFrame({{minute, Motion()}}));
    ASSERT_TRUE(other.reading()) << minute;
  }
  other.Send(BatchFrame({{11, Fault()}, {12, Motion()}}));
  EXPECT_TRUE(other.reading()) << "there is room for its fault";
  EXPECT_EQ(server().counts().applied, 11U);
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().counts().stored, 101U);
  EXPECT_EQ(greedy.TakeLines().back(), "ack 100 judged 100");
  EXPECT_EQ(other.TakeLines().back(), "ack 12 judged 12");
}

TEST_F(HoldBackTest, AFenceFreesTheRobotsShare) {
  limits_.journal.bytes_max = 3'200;
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}, {5, Motion()}}));
  EXPECT_GT(server().robot().sessions.journal_use().bytes, 500U);
  BenchServer other(clock_, database_, 99, limits_);
  static_cast<void>(other.Connect(SessionOf(9)));
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().robot().sessions.journal_use().bytes, 0U);
  EXPECT_EQ(server().robot().sessions.journal_use().records, 0U);
  EXPECT_EQ(server().counts().superseded, 1U);
}

TEST_F(HoldBackTest, PastItsFlowAStreamWaitsForItsTokens) {
  limits_.allowance.flow.records = {.rate = 10, .burst = 20};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 30, Fault())));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(Shown().held_back, HeldBack::kFlow);
  server().Commit();
  EXPECT_EQ(server().counts().stored, 20U);
  EXPECT_FALSE(stream.reading()) << "no commit ends it";
  server().Pass(milliseconds(99));
  EXPECT_EQ(server().counts().received, 20U);
  server().Pass(milliseconds(1));
  EXPECT_EQ(server().counts().received, 21U);
  server().Pass(milliseconds(900));
  EXPECT_EQ(server().counts().received, 30U);
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(Shown().held_back, HeldBack::kNone);
}

TEST_F(HoldBackTest, WhatIsRejectedOrSentAgainCostsNoTokens) {
  limits_.allowance.flow.records = {.rate = 1, .burst = 5};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 5, Fault())));
  stream.Send(BatchFrame(Messages(6, 40, BadFault())));
  EXPECT_TRUE(stream.reading());
  stream.Send(BatchFrame({{41, Fault()}}));
  EXPECT_FALSE(stream.reading());
  server().Commit();
  Start();
  BenchStream& again = server().Connect(SessionOf(1));
  again.Send(BatchFrame(Messages(1, 5, Fault())));
  EXPECT_TRUE(again.reading());
  again.Send(BatchFrame(Messages(41, 45, Fault())));
  EXPECT_TRUE(again.reading()) << "the tokens are all there";
  again.Send(BatchFrame({{46, Fault()}}));
  EXPECT_FALSE(again.reading());
}

TEST_F(HoldBackTest, AReloadOfTheFlowHoldsFromTheNextFrameOn) {
  limits_.allowance.flow.records = {.rate = 1, .burst = 1};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  server().allowances().Set({});
  stream.Send(BatchFrame(Messages(2, 100, Fault())));
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(server().counts().received, 100U);
}

TEST_F(HoldBackTest, JournalRecordsAreBoundedToo) {
  limits_.journal.records_max = 2;
  limits_.journal.robot_share = 1;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, Fault())));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(server().counts().received, 2U);
  server().Commit();
  EXPECT_EQ(server().counts().stored, 3U);
}

TEST_F(HoldBackTest, SkippedNumbersCountAgainstTheRobotsFlight) {
  limits_.session.in_flight_uplinks_max = 2;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{10, Motion()}, {20, Motion()}, {30, Motion()}}));
  EXPECT_EQ(server().counts().received, 2U) << "two gaps wait for the store";
  server().Commit();
  EXPECT_EQ(server().counts().received, 3U);
}

TEST_F(HoldBackTest, ACostlyFrameLetsOtherStreamsGoFirst) {
  limits_.session.batch_uplinks_max = 1000;
  BenchStream& stream = Welcomed();
  stream.StopReading();  // a write that is done is a turn too
  stream.SendOnce(BatchFrame(Messages(1, 2 * kCostlyPerTurn + 1, BadFault())));
  EXPECT_EQ(server().counts().received, kCostlyPerTurn);
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(Shown().held_back, HeldBack::kNone) << "it is not held back, it waits for its turn";
  server().DeliverWakes();
  EXPECT_EQ(server().counts().received, 2 * kCostlyPerTurn + 1);
  EXPECT_TRUE(stream.reading());
}

TEST_F(HoldBackTest, ADiskThatIsNearlyFullKeepsNoPayloadAndAFullOneNoRejection) {
  BenchStream& stream = Welcomed();
  server().robot().flow.LimitForDisk(1'000'000);
  stream.Send(BatchFrame({{1, BadFault()}}));
  server().Commit();
  EXPECT_EQ(server().counts().rejected, 1U);
  EXPECT_EQ(server().robot().flow.bytes_total(), 0U) << "no payload was kept";
  server().robot().flow.LimitForDisk(0);
  stream.Send(BatchFrame({{2, Motion()}, {3, BadFault()}}));
  EXPECT_EQ(server().counts().received, 2U) << "a live message passes, a rejection is a row";
  EXPECT_EQ(Shown().held_back, HeldBack::kDisk);
  server().robot().flow.LimitForDisk(std::nullopt);
  server().Pass(std::chrono::seconds(1));
  EXPECT_EQ(server().counts().received, 3U);
}

TEST_F(HoldBackTest, AFrameOfGoodMessagesIsProcessedInOneTurn) {
  limits_.session.batch_uplinks_max = 1000;
  BenchStream& stream = Welcomed();
  stream.SendOnce(BatchFrame(Messages(1, 1000, Motion())));
  EXPECT_EQ(server().counts().received, 1000U);
  EXPECT_TRUE(stream.reading());
}

/// A stream whose agent reads nothing while 1,024 Rejects wait for it.
class StalledTest : public HoldBackTest {
 protected:
  StalledTest() : stream_(Welcomed()) {
    stream_.StopReading();
    // Not all in one second, which would be held back as malformed.
    for (model::Seq first = 1; first <= 1025; first += 205) {
      server().Pass(std::chrono::seconds(1));
      stream_.Send(BatchFrame(Messages(first, first + 204, BadFault())));
    }
  }
  BenchStream& stream_;
};

TEST_F(StalledTest, AFullOutgoingQueueHoldsBack) {
  EXPECT_FALSE(stream_.reading());
  EXPECT_TRUE(server().robot().state.held_back());
  EXPECT_EQ(Shown().held_back, HeldBack::kUnread);
  EXPECT_EQ(stream_.end(), "");
}

TEST_F(StalledTest, ThirtySecondsOfTakingNothingEndTheStream) {
  server().Pass(kPeerStallMax - milliseconds(1));
  EXPECT_EQ(stream_.end(), "");
  server().Pass(milliseconds(1));
  EXPECT_EQ(stream_.end(),
            "RESOURCE_EXHAUSTED: the agent read nothing for 30 s while 1024 frames waited for it");
  EXPECT_TRUE(stream_.cancelled());
  EXPECT_EQ(server().probe().peer_stalls_total.value(), 1);
  server().Commit();
  EXPECT_EQ(server().counts().rejected, server().counts().received) << "what was taken commits";
}

TEST_F(StalledTest, OneFrameTakenBeginsTheThirtySecondsAnew) {
  server().Pass(kPeerStallMax - milliseconds(1));
  stream_.ReadOne();
  server().Pass(kPeerStallMax - milliseconds(1));
  EXPECT_EQ(stream_.end(), "");
}

TEST_F(StalledTest, ReadingAgainGoesOn) {
  stream_.ReadAgain();
  EXPECT_TRUE(stream_.reading());
  EXPECT_FALSE(server().robot().state.held_back());
  server().Pass(kPeerStallMax * 2);
  EXPECT_EQ(stream_.end(), "");
}

TEST_F(HoldBackTest, MoreThanAThousandMalformedASecondHoldBack) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 250, BadFault())));
  stream.Send(BatchFrame(Messages(251, 500, BadFault())));
  stream.Send(BatchFrame(Messages(501, 750, BadFault())));
  stream.Send(BatchFrame(Messages(751, 1000, BadFault())));
  EXPECT_TRUE(stream.reading()) << "a thousand a second pass";
  stream.Send(BatchFrame({{1001, BadFault()}, {1002, BadFault()}}));
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(server().counts().received, 1001U);
  EXPECT_EQ(Shown().held_back, HeldBack::kMalformed);
  server().Pass(milliseconds(100));
  EXPECT_FALSE(stream.reading());
  server().Pass(milliseconds(1));
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(server().counts().received, 1002U);
}

TEST_F(HoldBackTest, ALargeMalformedFrameIsSpreadOverSeconds) {
  limits_.session.batch_uplinks_max = 4000;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 2500, BadFault())));
  EXPECT_EQ(server().counts().received, 1001U);
  server().Pass(milliseconds(101));
  EXPECT_EQ(server().counts().received, 1102U) << "a hundred at a time, and the one that ends it";
  server().Pass(std::chrono::seconds(1));
  EXPECT_EQ(server().counts().received, 2102U);
  EXPECT_FALSE(stream.reading());
  server().Pass(std::chrono::seconds(1));
  EXPECT_EQ(server().counts().received, 2500U);
  EXPECT_TRUE(stream.reading());
}

TEST_F(HoldBackTest, AReconnectBeginsNoNewSecondOfMalformedMessages) {
  limits_.session.batch_uplinks_max = 1000;
  BenchStream& first = Welcomed();
  first.Send(BatchFrame(Messages(1, 1000, BadFault())));
  EXPECT_TRUE(first.reading());
  first.Break();
  server().Commit();
  BenchStream& second = server().Connect(SessionOf(1), 1000, 1000);
  EXPECT_TRUE(second.reading()) << "at the bound";
  second.Send(BatchFrame({{1001, BadFault()}, {1002, Fault()}}));
  EXPECT_EQ(server().counts().received, 1001U);
  EXPECT_FALSE(second.reading()) << "past it";
  second.Break();
  BenchStream& third = server().Connect(SessionOf(2));
  EXPECT_FALSE(third.reading());
  EXPECT_EQ(Shown().held_back, HeldBack::kMalformed);
  server().Pass(milliseconds(100));
  EXPECT_FALSE(third.reading());
  server().Pass(milliseconds(1));
  EXPECT_TRUE(third.reading());
}

TEST_F(HoldBackTest, ATakeoverBeginsNoNewSecondOfMalformedMessages) {
  limits_.session.batch_uplinks_max = 1000;
  BenchStream& older = Welcomed();
  older.Send(BatchFrame(Messages(1, 1000, BadFault())));
  server().Commit();
  BenchStream& newer = server().Connect(SessionOf(2));
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_TRUE(newer.reading()) << "at the bound";
  newer.Send(BatchFrame({{1, BadFault()}, {2, Motion()}}));
  EXPECT_EQ(server().counts().received, 1001U);
  EXPECT_FALSE(newer.reading()) << "past it";
  server().Pass(std::chrono::seconds(1));
  EXPECT_TRUE(newer.reading());
  EXPECT_EQ(server().counts().received, 1002U);
}

TEST_F(HoldBackTest, NothingIsDroppedWhileHeldBack) {
  limits_.session.in_flight_uplinks_max = 3;
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame(Messages(1, 50, Fault())));
  server().Commit();
  server().Pass(std::chrono::minutes(10));
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(server().counts().stored, 50U);
  EXPECT_EQ(stream.TakeLines().back(), "ack 50 judged 50");
}

TEST_F(HoldBackTest, PresenceIsUnknownInsteadOfOffline) {
  limits_.session.in_flight_uplinks_max = 2;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}, {2, Fault()}, {3, Fault()}, {4, Fault()}}));
  server().Pass(std::chrono::seconds(10));
  EXPECT_EQ(Swept(), robot::Presence::kOnline);
  server().Pass(milliseconds(1));
  EXPECT_EQ(Swept(), robot::Presence::kUnknown);
  server().Commit();
  EXPECT_EQ(Swept(), robot::Presence::kUnknown) << "for presence.timeout after";
  // Sweep by sweep: one that came late would be a standstill of the server.
  for (int i = 0; i < 5; ++i) {
    server().Pass(std::chrono::seconds(2));
    EXPECT_EQ(Swept(), robot::Presence::kUnknown);
  }
  server().Pass(milliseconds(1));
  EXPECT_EQ(Swept(), robot::Presence::kOffline);
}

TEST_F(HoldBackTest, ABreakEndsIt) {
  limits_.session.in_flight_uplinks_max = 1;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, Fault()}}));
  stream.Break();
  EXPECT_FALSE(server().robot().state.held_back());
  EXPECT_EQ(Shown().held_back, HeldBack::kNone);
  EXPECT_EQ(server().probe().held_back.value(), 0);
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1)) << "2 was never taken";
  EXPECT_THAT(server().Connect(SessionOf(1)).TakeLines(),
              ElementsAre("welcome 1", "ack 1 judged 1"));
}

}  // namespace
}  // namespace uplink::session
