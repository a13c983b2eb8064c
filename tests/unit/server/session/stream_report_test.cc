// Streams as connections of their robots: what is reported at their begin and their end.
#include "server/session/stream_report.h"

#include "schema/base/rfc3339.h"
#include "tests/support/kept_connections.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using transport::EndCause;

class StreamReportTest : public SessionTest {
 protected:
  StreamReportTest() { Reported(); }
  /// Its streams report to what goes before it.
  ~StreamReportTest() override {
    ExpectBalanced();
    server_.reset();
  }
  BenchServer& Reported() {
    server().reports = &kept_.reports();
    return server();
  }
  BenchStream& Welcomed() { return server().Connect(SessionOf(1)); }
  /// The one end: its reason, and code and sentence as `CODE: sentence`.
  [[nodiscard]] std::vector<std::string> End() const {
    const std::vector<storage::ConnectionItem> ended = kept_.ended();
    if (ended.size() != 1) return {"not one end"};
    const storage::ConnectionEnded& end = *ended[0].ended;
    return {std::string(model::ToText(end.why)), end.code + ": " + end.detail};
  }

  testing::KeptConnections kept_{clock_};
};

TEST_F(StreamReportTest, BeginsWithAValidHello) {
  BenchStream& stream = server().Open();
  EXPECT_THAT(kept_.begun(), IsEmpty());
  v1::RelayRequest hello = HelloFrame(SessionOf(1));
  hello.mutable_hello()->set_agent_version("agent \n1.2");
  stream.Send(hello);
  ASSERT_THAT(kept_.begun(), SizeIs(1));
  const storage::ConnectionItem item = kept_.begun()[0];
  EXPECT_EQ(item.robot->ruri, kRobot);
  EXPECT_EQ(item.source, model::MessageSource::kUplink);
  EXPECT_EQ(item.began_at, clock_.System());
  EXPECT_EQ(item.agent_version, "agent \\x0a1.2");
  EXPECT_FALSE(item.ended);
}

TEST_F(StreamReportTest, IsNoneWithoutAValidHello) {
  BenchStream& stream = server().Open();
  stream.Send(BatchFrame({{1, Motion()}}));
  EXPECT_EQ(stream.end().substr(0, 16), "INVALID_ARGUMENT");
  server().Open().Break();
  EXPECT_THAT(kept_.begun(), IsEmpty());
  EXPECT_THAT(kept_.ended(), IsEmpty());
}

TEST_F(StreamReportTest, CountsMessagesAndBytes) {
  BenchStream& stream = Welcomed();
  const v1::RelayRequest batch = BatchFrame({{1, Motion()}, {2, Motion()}});
  stream.Send(batch);
  stream.Break();
  ASSERT_THAT(kept_.ended(), SizeIs(1));
  EXPECT_EQ(kept_.ended()[0].messages, 2U);
  EXPECT_GE(kept_.ended()[0].bytes, batch.ByteSizeLong());
}

TEST_F(StreamReportTest, IsKeptAgainWithWhatItBroughtNowAndThen) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Motion()}}));
  clock_.Advance(robot::kConnectionUpdateEvery - milliseconds(1));
  stream.Send(BatchFrame({{2, Motion()}}));
  EXPECT_THAT(kept_.updated(), IsEmpty());
  clock_.Advance(milliseconds(1));
  stream.Send(BatchFrame({{3, Motion()}}));
  stream.Send(BatchFrame({{4, Motion()}}));
  ASSERT_THAT(kept_.updated(), SizeIs(1));
  EXPECT_EQ(kept_.updated()[0].messages, 3U);
  EXPECT_EQ(kept_.updated()[0].id, kept_.begun()[0].id);
  EXPECT_FALSE(kept_.updated()[0].ended);
}

TEST_F(StreamReportTest, SaysHowLongItWasHeldBackAndWhy) {
  limits_.session.in_flight_uplinks_max = 1;
  Start();
  BenchStream& stream = Reported().Connect(SessionOf(1));
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}, {2, Fault()}}));
  clock_.Advance(milliseconds(300));
  stream.Break();
  ASSERT_THAT(kept_.ended(), SizeIs(1));
  EXPECT_EQ(kept_.ended()[0].held_back, milliseconds(300));
  EXPECT_EQ(kept_.ended()[0].held_back_why, "in_flight");
}

TEST_F(StreamReportTest, AHalfCloseThatSettlesIsOrderly) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  EXPECT_THAT(kept_.ended(), IsEmpty()) << "it settles";
  server().Commit();
  EXPECT_THAT(End(), ElementsAre("orderly", "OK: the robot closed it"));
  EXPECT_EQ(server().robot().state.last_end(), model::ConnectionEnd::kOrderly);
}

TEST_F(StreamReportTest, AHalfCloseAfterAGoodbyeSaysUntilWhen) {
  BenchStream& stream = Welcomed();
  v1::RelayRequest goodbye;
  const SystemTime back = clock_.System() + std::chrono::hours(2);
  goodbye.mutable_goodbye()->set_expected_back_unix_ms(UnixMs(back));
  stream.Send(goodbye);
  stream.HalfClose();
  EXPECT_THAT(End(),
              ElementsAre("orderly", "OK: the robot said Goodbye until " + uplink::Rfc3339(back)));
}

TEST_F(StreamReportTest, AHalfCloseThatDoesNotSettleInTimeIsOrderlyToo) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  server().Pass(limits_.session.drain_timeout);
  EXPECT_THAT(End(),
              ElementsAre("orderly", "UNAVAILABLE: not all was settled within drain.timeout"));
}

TEST_F(StreamReportTest, ACutAfterAHalfCloseIsBroken) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Fault()}}));
  stream.HalfClose();
  stream.Break();
  EXPECT_THAT(End(), ElementsAre("broken", ": the connection was cut"));
}

TEST_F(StreamReportTest, WhatTheTransportFindsIsToldByItsCause) {
  Welcomed().session().OnBroken({.cause = EndCause::kReset, .code = absl::StatusCode::kCancelled});
  EXPECT_THAT(End(), ElementsAre("broken", "CANCELLED: the agent reset the stream"));
}

TEST_F(StreamReportTest, SilenceIsSilent) {
  Welcomed().session().OnBroken({.cause = EndCause::kUnanswered});
  EXPECT_THAT(End(), ElementsAre("silent", ": nothing answered the server's keepalive"));
}

TEST_F(StreamReportTest, ANewerStreamReplacesItAndIsItsTakeover) {
  static_cast<void>(Welcomed());
  BenchStream& second = server().Connect(SessionOf(1));
  EXPECT_THAT(End(), ElementsAre("replaced", "ABORTED: superseded"));
  EXPECT_EQ(server().robot().state.last_end(), std::nullopt) << "it is connected";
  second.Break();
  EXPECT_EQ(kept_.ended().at(1).takeovers, 1U);
  EXPECT_EQ(server().robot().state.last_end(), model::ConnectionEnd::kBroken);
}

TEST_F(StreamReportTest, ADrainedStreamIsDrainedHoweverItsAgentLeaves) {
  Welcomed().Drain(milliseconds(5000));
  EXPECT_THAT(End(), ElementsAre("drained", "UNAVAILABLE: the server drains"));
  BenchStream& second = server().Connect(SessionOf(1));
  server().StoreAway();
  second.Send(BatchFrame({{1, Fault()}}));
  second.Drain(milliseconds(5000));
  second.Break();
  EXPECT_THAT(kept_.Ends(), ElementsAre("drained", "drained"));
}

TEST_F(StreamReportTest, TheEndOfItsCertificateIsNoDrain) {
  Welcomed().Drain(milliseconds(5000), EndCause::kExpired);
  EXPECT_THAT(End(),
              ElementsAre("certificate_expired", "UNAVAILABLE: its certificate has expired"));
}

TEST_F(StreamReportTest, AnAgentThatDoesNotReadIsNotRead) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  // Not all in one second, which would be held back as malformed.
  for (model::Seq first = 1; first <= 1025; first += 205) {
    server().Pass(std::chrono::seconds(1));
    stream.Send(BatchFrame(Messages(first, first + 204, BadFault())));
  }
  server().Pass(kPeerStallMax);
  EXPECT_EQ(kept_.Ends(), std::vector<std::string>{"not_read"});
}

TEST_F(StreamReportTest, ABrokenRuleIsAProtocolError) {
  Welcomed().Send(HelloFrame(SessionOf(1)));
  EXPECT_THAT(End(), ElementsAre("protocol_error",
                                 "INVALID_ARGUMENT: frame 2: hello: only the "
                                 "first frame may be one"));
}

TEST_F(StreamReportTest, AFrameThatIsTooLargeIsAProtocolError) {
  Welcomed().SendTooLarge(limits_.session.frame_bytes_max + 1);
  EXPECT_THAT(End().front(), "protocol_error");
}

TEST_F(StreamReportTest, AStreamThatAnOperatorEndsIsRefused) {
  static_cast<void>(Welcomed());
  server().robot().sessions.EndStream().Wake();
  server().DeliverWakes();
  EXPECT_THAT(End(), ElementsAre("refused", "UNAVAILABLE: an operator ended the stream"));
}

TEST_F(StreamReportTest, AStreamWithTooManyUnconfirmedRejectsIsRefused) {
  limits_.session.unconfirmed_rejects_max = 2;
  Start();
  Reported().Connect(SessionOf(1)).Send(BatchFrame({{1, BadFault()}, {2, BadFault()}}));
  server().Commit();
  EXPECT_THAT(End().front(), "refused");
}

TEST_F(StreamReportTest, AServerThatStopsEndsIt) {
  Welcomed().session().OnBroken({.cause = EndCause::kServerStops});
  EXPECT_THAT(End(), ElementsAre("server_ended", ": the server stopped"));
}

}  // namespace
}  // namespace uplink::session
