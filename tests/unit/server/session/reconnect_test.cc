// Streams of one robot that come too often wait for their turn; whatever else goes on meanwhile.
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ReconnectTest : public SessionTest {
 protected:
  /// So many streams come and break off at once.
  void ComeAndGo(std::size_t streams) {
    for (; streams > 0; --streams) server().Connect(SessionOf(1)).Break();
    server().Commit();
  }
  /// As many as wait for nothing.
  void UseTheMinute() { ComeAndGo(robot::kStreamsPerMinuteMax); }
  BenchStream& Come(std::uint8_t session = 1) {
    BenchStream& stream = server().Connect(SessionOf(session));
    server().Commit();
    return stream;
  }
  robot::Presence Swept() {
    server().fleet().Sweep(limits_.session.session_idle);
    return server().robot().state.presence();
  }
  [[nodiscard]] std::int64_t Waiting() { return server().probe().waiting.value(); }
};

TEST_F(ReconnectTest, TheTenthOfAMinuteIsAnsweredAtOnceTheEleventhWaits) {
  ComeAndGo(robot::kStreamsPerMinuteMax - 1);
  BenchStream& tenth = Come();
  EXPECT_THAT(tenth.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  tenth.Break();
  BenchStream& stream = Come();
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  EXPECT_FALSE(stream.reading());
  EXPECT_EQ(Waiting(), 1);
  EXPECT_EQ(server().probe().delayed_total.value(), 1);
  server().Pass(milliseconds(99));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  EXPECT_FALSE(server().robot().sessions.View().connected);
  server().Pass(milliseconds(1));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
  EXPECT_TRUE(stream.reading());
  EXPECT_EQ(Waiting(), 0);
}

TEST_F(ReconnectTest, OtherRobotsDoNotWait) {
  UseTheMinute();
  Come();
  BenchStream& other = server().Connect(SessionOf(1), 0, 0, "rcan://bench/2");
  EXPECT_THAT(other.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(ReconnectTest, TheOlderStreamFlowsWhileTheNewerWaits) {
  ComeAndGo(robot::kStreamsPerMinuteMax - 1);
  BenchStream& older = Come();
  static_cast<void>(older.TakeLines());
  BenchStream& newer = Come();
  older.Send(BatchFrame({{1, Fault()}}));
  server().Commit();
  EXPECT_THAT(older.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_THAT(newer.TakeLines(), IsEmpty());
  server().Pass(milliseconds(100));
  server().Commit();
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 1", "ack 1 judged 1"));
}

TEST_F(ReconnectTest, AWaitingStreamWhosePeerBreaksLeavesAtOnce) {
  ComeAndGo(robot::kStreamsPerMinuteMax - 1);
  BenchStream& older = Come();
  BenchStream& newer = Come();
  newer.Break();
  EXPECT_TRUE(newer.session().done());
  EXPECT_EQ(Waiting(), 0);
  server().Pass(milliseconds(100));
  server().Commit();
  EXPECT_EQ(older.end(), "") << "no stream took over";
}

TEST_F(ReconnectTest, AWaitingStreamEndsAtOnceWhenTheServerDrains) {
  UseTheMinute();
  BenchStream& stream = Come();
  stream.Drain(std::chrono::seconds(5));
  EXPECT_EQ(stream.end(), "UNAVAILABLE: the server drains");
  EXPECT_EQ(Waiting(), 0);
}

TEST_F(ReconnectTest, TheTimeForItsHelloDoesNotEndAWaitingStream) {
  BenchStream& stream = server().Open();
  ComeAndGo(100);
  server().Pass(kHelloWait - milliseconds(1));
  stream.Send(HelloFrame(SessionOf(1)));
  EXPECT_EQ(Waiting(), 1);
  server().Pass(robot::kStreamDelayMax - milliseconds(1));
  EXPECT_EQ(stream.end(), "");
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  server().Pass(milliseconds(1));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(ReconnectTest, FourWaitAndOneMoreIsRefused) {
  UseTheMinute();
  for (std::size_t i = 0; i < robot::kStreamsWaitingMax; ++i) EXPECT_EQ(Come().end(), "");
  EXPECT_EQ(Come().end(),
            "RESOURCE_EXHAUSTED: 4 streams of the robot wait already: they come too often");
  EXPECT_EQ(server().probe().refused_waiting_total.value(), 1);
  EXPECT_EQ(Waiting(), 4);
}

TEST_F(ReconnectTest, AStreamThatWaitedDoesNotTakeOverFromOneThatCameLater) {
  ComeAndGo(100);
  server().Pass(std::chrono::minutes(1));
  BenchStream& older = Come(1);
  EXPECT_EQ(Waiting(), 1) << "for five seconds";
  server().Pass(milliseconds(1));
  BenchStream& newer = Come(2);
  EXPECT_THAT(newer.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"))
      << "the minute is empty";
  server().Pass(robot::kStreamDelayMax);
  server().Commit();
  EXPECT_EQ(older.end(), "ABORTED: superseded");
  EXPECT_EQ(newer.end(), "");
  EXPECT_TRUE(server().robot().sessions.View().connected);
}

TEST_F(ReconnectTest, SilenceOfARobotThatWaitsIsOurs) {
  BenchStream& first = Come();
  first.Send(BatchFrame({{1, Motion()}}));
  first.Break();
  ComeAndGo(100);
  for (int i = 0; i < 3; ++i) {
    server().Pass(std::chrono::seconds(3));
    EXPECT_EQ(Swept(), robot::Presence::kOnline);
  }
  Come();
  server().Pass(std::chrono::seconds(2));
  EXPECT_EQ(Swept(), robot::Presence::kUnknown) << "silent for 11 s; 2 of them it waited";
  for (int i = 0; i < 6; ++i) {
    server().Pass(milliseconds(2'100));
    EXPECT_EQ(Swept(), robot::Presence::kUnknown) << "presence.timeout after its wait";
  }
  server().Pass(milliseconds(401));
  EXPECT_EQ(Swept(), robot::Presence::kOffline);
}

TEST_F(ReconnectTest, ARobotThatIsOfflineStaysSoWhileItsStreamWaits) {
  BenchStream& first = Come();
  first.Send(BatchFrame({{1, Motion()}}));
  first.Break();
  for (int i = 0; i < 6; ++i) {
    server().Pass(std::chrono::seconds(2));
    static_cast<void>(Swept());
  }
  EXPECT_EQ(Swept(), robot::Presence::kOffline);
  ComeAndGo(100);
  EXPECT_EQ(Swept(), robot::Presence::kOffline);
}

}  // namespace
}  // namespace uplink::session
