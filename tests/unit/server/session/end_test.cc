// How streams end: half-closed, drained, broken, invalid.
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class EndTest : public SessionTest {
 protected:
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
};

TEST_F(EndTest, HalfCloseSettlesThenALastAckThenOk) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, Motion()}}));
  stream.HalfClose();
  EXPECT_EQ(stream.end(), "");
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 2 judged 2");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(EndTest, HalfCloseWithNothingWaitingEndsAtOnce) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}}));
  stream.HalfClose();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(EndTest, HalfCloseTellsTheStoresRejectsBeforeTheLastAck) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, RefusedFault()}}));
  stream.HalfClose();
  server().Commit();
  const std::vector<std::string> said = stream.TakeLines();
  EXPECT_EQ(said.front(), "reject 1 store_refused faultId");
  EXPECT_EQ(said.back(), "ack 1 judged 1");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(EndTest, HalfCloseWaitsForASlowReader) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame({{1, BadFault()}, {2, BadFault()}}));
  stream.HalfClose();
  server().Commit();
  EXPECT_EQ(stream.end(), "");
  stream.ReadAgain();
  EXPECT_EQ(stream.TakeLines().back(), "ack 2 judged 2");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(EndTest, HalfCloseEndsUnavailableWhenDrainTimeoutPasses) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  server().Pass(limits_.session.drain_timeout - milliseconds(1));
  EXPECT_EQ(stream.end(), "");
  server().Pass(milliseconds(1));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1)) << "what was taken commits all the same";
}

TEST_F(EndTest, DrainTellsReadsNoMoreSettlesAndEndsUnavailable) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.Drain(milliseconds(5000));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("drain 5000"));
  stream.Send(BatchFrame({{2, Fault()}}));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 1 judged 1");
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
  EXPECT_EQ(server().counts().received, 1U);
}

TEST_F(EndTest, DrainWithNothingWaitingEndsAtOnce) {
  BenchStream& stream = Welcomed();
  stream.Drain(milliseconds(5000));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("drain 5000", "ack 0 judged 0"));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
}

TEST_F(EndTest, DrainEndsWhenItsGracePasses) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.Drain(milliseconds(5000));
  server().Pass(milliseconds(4999));
  EXPECT_EQ(stream.end(), "");
  server().Pass(milliseconds(1));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
  EXPECT_EQ(server().counts().in_flight, 1);
}

TEST_F(EndTest, DrainLeavesWhatWasNotJudgedToTheAgent) {
  limits_.session.in_flight_uplinks_max = 2;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 5, Fault())));
  stream.Drain(milliseconds(5000));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 2 judged 2");
  EXPECT_EQ(server().counts().received, 2U);
  EXPECT_FALSE(server().robot().state.held_back());
}

TEST_F(EndTest, DrainAfterAHalfCloseStillEndsOk) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  stream.Drain(milliseconds(5000));
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 1 judged 1");
  EXPECT_EQ(stream.end(), "OK");
}

TEST_F(EndTest, DrainAfterAHalfCloseShortensItsTime) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  stream.Drain(milliseconds(1000));
  server().Pass(milliseconds(1000));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: not all was settled within drain.timeout");
}

TEST_F(EndTest, DrainBeforeHelloEndsAtOnce) {
  BenchStream& stream = server().Open();
  stream.Drain(milliseconds(5000));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
}

TEST_F(EndTest, DrainWhileTheStoreIsAskedEndsAtOnce) {
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  stream.Drain(milliseconds(5000));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
  EXPECT_FALSE(server().robot().sessions.View().connected);
}

TEST_F(EndTest, DrainWhileWaitingForAnOlderStreamEndsAtOnce) {
  BenchStream& older = Welcomed();
  BenchStream& newer = server().Open();
  newer.Send(HelloFrame(SessionOf(1)));
  newer.Drain(milliseconds(5000));
  EXPECT_EQ(newer.end(), "UNAVAILABLE: the server drains");
  older.Drain(milliseconds(5000));
  server().Commit();
  EXPECT_FALSE(server().robot().sessions.View().connected);
}

TEST_F(EndTest, ABreakLosesNothingThatWasTaken) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, BadFault()}, {3, Fault()}}));
  stream.Break();
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 3));
  EXPECT_EQ(server().counts().stored, 2U);
  EXPECT_EQ(server().counts().rejected, 1U);
  EXPECT_EQ(server().counts().in_flight, 0);
}

TEST_F(EndTest, AProtocolErrorLosesNothingThatWasTaken) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.SendBytes("garbage");
  EXPECT_THAT(stream.end(), ::testing::StartsWith("INVALID_ARGUMENT: frame 3: "));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1));
}

TEST_F(EndTest, StreamsAreCountedWhileTheyLive) {
  BenchStream& first = Welcomed();
  server().Connect(SessionOf(1), 0, 0, "rcan://bench/2");
  EXPECT_EQ(server().probe().streams.value(), 2);
  EXPECT_EQ(server().probe().streams_total.value(), 2);
  EXPECT_TRUE(server().robot().sessions.View().connected);
  first.Break();
  EXPECT_FALSE(server().robot().sessions.View().connected);
}

}  // namespace
}  // namespace uplink::session
