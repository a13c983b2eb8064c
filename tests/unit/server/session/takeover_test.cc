// One robot has one stream: what happens to the older one, and to what it had processed.
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class TakeoverTest : public SessionTest {
 protected:
  /// How often streams come is not the matter here.
  TakeoverTest() { limits_.session.reconnects.per_minute = robot::kStreamTimesMax; }
};

TEST_F(TakeoverTest, TheNewerStreamWaitsUntilTheOlderHasConfirmed) {
  BenchStream& older = server().Connect(SessionOf(1));
  BenchStream& newer = server().Open();
  newer.Send(HelloFrame(SessionOf(1)));
  server().Advance();
  EXPECT_EQ(older.end(), "") << "its own queue has not run yet";
  EXPECT_THAT(newer.TakeLines(), IsEmpty());
  server().DeliverWakes();
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_THAT(newer.TakeLines(), IsEmpty());
  server().Commit();
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_EQ(server().probe().takeovers_total.value(), 1);
  EXPECT_EQ(server().probe().superseded_total.value(), 1);
}

TEST_F(TakeoverTest, AStreamThatAnOperatorEndsLeavesWhatItTookToCommit) {
  BenchStream& stream = server().Connect(SessionOf(1));
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  server().robot().sessions.EndStream().Wake();
  server().DeliverWakes();
  EXPECT_EQ(stream.end(), "UNAVAILABLE: an operator ended the stream");
  EXPECT_EQ(server().probe().superseded_total.value(), 0);
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1));
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 2", "ack 2 judged 2"));
}

TEST_F(TakeoverTest, TheSameSessionGoesOnInTheSameWindow) {
  BenchStream& older = server().Connect(SessionOf(1));
  older.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  BenchStream& newer = server().Connect(SessionOf(1));
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 2"));
  newer.Send(BatchFrame({{1, Fault()}, {3, Fault()}}));
  server().Commit();
  EXPECT_THAT(newer.TakeLines(), ElementsAre("ack 3 judged 3"));
  EXPECT_EQ(server().counts().duplicate, 1U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 3));
}

TEST_F(TakeoverTest, AnotherSessionLeavesTheOldersRecordsToCommit) {
  BenchStream& older = server().Connect(SessionOf(1));
  older.Send(BatchFrame({{1, Fault()}}));
  BenchStream& newer = server().Connect(SessionOf(2));
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1));
  EXPECT_EQ(server().counts().superseded, 0U);
  EXPECT_THAT(newer.TakeLines(), IsEmpty()) << "the commit was of another session";
}

TEST_F(TakeoverTest, OfThreeStreamsTheLastStays) {
  BenchStream& first = server().Connect(SessionOf(1));
  BenchStream& second = server().Open();
  BenchStream& third = server().Open();
  second.Send(HelloFrame(SessionOf(1)));
  third.Send(HelloFrame(SessionOf(1)));
  server().Commit();
  EXPECT_EQ(first.end(), "ABORTED: superseded");
  EXPECT_EQ(second.end(), "ABORTED: superseded");
  EXPECT_THAT(second.frames(), IsEmpty());
  EXPECT_THAT(third.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_EQ(server().probe().takeovers_total.value(), 2);
}

TEST_F(TakeoverTest, AWaitingStreamThatBreaksLeavesNoOneWaiting) {
  BenchStream& first = server().Connect(SessionOf(1));
  BenchStream& second = server().Open();
  second.Send(HelloFrame(SessionOf(1)));
  second.Break();
  server().Commit();
  EXPECT_EQ(first.end(), "ABORTED: superseded") << "it was told before the newer one broke";
  EXPECT_FALSE(server().robot().sessions.View().connected);
  EXPECT_THAT(server().Connect(SessionOf(1)).TakeLines(),
              ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(TakeoverTest, AStreamThatWaitsForTheStoreIsSupersededToo) {
  server().StoreAway();
  BenchStream& older = server().Connect(SessionOf(1));
  BenchStream& newer = server().Connect(SessionOf(1));
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(TakeoverTest, PresenceDoesNotChange) {
  BenchStream& older = server().Connect(SessionOf(1));
  older.Send(BatchFrame({{1, Motion()}}));
  const SystemTime since =
      server().robot().state.Snapshot(robot::RobotState::Parts::kNone).presence_since;
  server().Pass(milliseconds(500));
  server().Connect(SessionOf(2));
  server().fleet().Sweep(limits_.session.session_idle);
  const auto snapshot = server().robot().state.Snapshot(robot::RobotState::Parts::kNone);
  EXPECT_EQ(snapshot.presence, robot::Presence::kOnline);
  EXPECT_EQ(snapshot.presence_since, since);
}

TEST_F(TakeoverTest, TenInAMinuteAreNotContestedElevenAre) {
  server().Connect(SessionOf(1));
  for (int i = 0; i < 10; ++i) server().Connect(SessionOf(1));
  EXPECT_FALSE(server().robot().sessions.View().contested);
  server().Connect(SessionOf(1));
  EXPECT_TRUE(server().robot().sessions.View().contested);
  EXPECT_EQ(server().probe().contested_total.value(), 1);
  server().Connect(SessionOf(1));
  EXPECT_EQ(server().probe().contested_total.value(), 1) << "it was flagged already";
}

TEST_F(TakeoverTest, TheFlagGoesWithTheMinute) {
  server().Connect(SessionOf(1));
  for (int i = 0; i < 11; ++i) server().Connect(SessionOf(1));
  server().Pass(std::chrono::minutes(1));
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_TRUE(server().robot().sessions.View().contested);
  server().Pass(milliseconds(1));
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_FALSE(server().robot().sessions.View().contested);
}

}  // namespace
}  // namespace uplink::session
