// Telemetry over the rate of its robot: superseded undecoded, but for the latest of each kind.
#include <cstddef>
#include <string>
#include <vector>

#include "schema/encode.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kBurst = 10;
constexpr double kLastOfBurst = kBurst;
/// The bucket gives one message in this time.
constexpr milliseconds kPerMessage{100};
constexpr std::size_t kMotion = static_cast<std::size_t>(model::Variant::kMotionTelemetry);

std::string Status(double range) {
  model::StatusTelemetry status;
  status.range_remaining = range;
  return schema::Encode(status);
}

std::string Extras(const std::string& key) {
  model::TelemetryExtras extras;
  extras.kv.emplace_back();
  extras.kv.back().key = key;
  extras.kv.back().value = std::int32_t{1};
  return schema::Encode(extras);
}

std::string RcanState(int time, int seq) {
  return R"({"ruri":"rcan://bench/1","timestamp_us":)" + std::to_string(time) + R"(,"seq":)" +
         std::to_string(seq) + "}";
}

class TelemetryRateTest : public SessionTest {
 protected:
  TelemetryRateTest() {
    limits_.allowance.telemetry = {.rate = 10, .burst = kBurst};
    stream_ = &server().Connect(SessionOf(1));
    static_cast<void>(stream_->TakeLines());
  }
  /// Latitudes 1 to `count` in one frame.
  void SendMotions(std::size_t count) {
    std::vector<Message> messages;
    for (std::size_t i = 1; i <= count; ++i) {
      messages.push_back({++seq_, Motion(static_cast<double>(i))});
    }
    stream_->Send(BatchFrame(messages));
  }
  void Send(const std::string& payload) { stream_->Send(BatchFrame({{++seq_, payload}})); }
  void SendRcan(int time) { SendRcanState(RcanState(time, time)); }
  void SendRcanState(const std::string& state) {
    v1::RelayRequest frame;
    v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
    uplink.set_seq(++seq_);
    uplink.set_rcan_robot_state(state);
    stream_->Send(frame);
  }
  robot::LiveParts Parts() {
    return server().robot().state.Snapshot(robot::RobotState::Parts::kAll).parts;
  }
  double Latitude() { return Parts().motion->pose->lat_deg; }
  [[nodiscard]] std::uint64_t Decoded() { return server().counts().records[kMotion]; }
  [[nodiscard]] std::int64_t OverRate() { return server().probe().over_rate_total[0].value(); }

  BenchStream* stream_ = nullptr;
  model::Seq seq_ = 0;
};

TEST_F(TelemetryRateTest, UpToTheRateEachMessageIsDecoded) {
  SendMotions(kBurst);
  EXPECT_EQ(Decoded(), kBurst);
  EXPECT_EQ(Latitude(), kLastOfBurst);
  EXPECT_EQ(OverRate(), 0);
  EXPECT_EQ(server().counts().received, kBurst);
}

TEST_F(TelemetryRateTest, PastItTheyAreSupersededUndecodedAndTheLatestWins) {
  SendMotions(60);
  EXPECT_EQ(Decoded(), kBurst);
  EXPECT_EQ(OverRate(), 49) << "the last one waits for the rate";
  SendMotions(80);
  EXPECT_EQ(Decoded(), kBurst);
  EXPECT_EQ(OverRate(), 129);
  server().Pass(kPerMessage);
  EXPECT_EQ(Decoded(), kBurst + 1);
  EXPECT_EQ(Latitude(), 80);
  const metrics::MessageCounts counts = server().counts();
  EXPECT_EQ(counts.received, 140U);
  EXPECT_EQ(counts.applied, 2U);
  EXPECT_EQ(counts.superseded, 138U);
  EXPECT_EQ(counts.in_flight, 0);
  EXPECT_EQ(server().robot().rates.limited(model::Variant::kMotionTelemetry), 129U);
  server().Pass(limits_.session.ack_interval);
  EXPECT_EQ(stream_->TakeLines().back(), "ack 140 judged 140");
}

TEST_F(TelemetryRateTest, AFloodDecodesNoMoreThanTheRate) {
  for (int i = 0; i < 100; ++i) {
    SendMotions(50);
    server().Pass(milliseconds(10));
  }
  // A second: what was there at once, and the rate.
  EXPECT_GE(Decoded(), kBurst + 9);
  EXPECT_LE(Decoded(), kBurst + 11);
  server().Pass(kPerMessage);
  EXPECT_EQ(server().counts().received, 5000U);
  EXPECT_EQ(Latitude(), 50);
}

TEST_F(TelemetryRateTest, AFaultBehindThemIsNotDelayed) {
  std::vector<Message> messages = Messages(1, 200, Motion());
  messages.push_back({201, Fault()});
  stream_->Send(BatchFrame(messages));
  EXPECT_TRUE(stream_->reading());
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(201));
  EXPECT_EQ(stream_->TakeLines().back(), "ack 201 judged 201");
}

TEST_F(TelemetryRateTest, EachKindHasItsLatest) {
  SendMotions(kBurst);
  Send(Status(1));
  Send(Status(2));
  Send(Extras("a"));
  Send(Extras("b"));
  SendRcan(1);
  SendRcan(2);
  EXPECT_FALSE(Parts().status.has_value());
  EXPECT_FALSE(Parts().rcan.has_value());
  server().Pass(kPerMessage);
  EXPECT_EQ(Parts().status->range_remaining, 2);
  ASSERT_EQ(Parts().extras.items().size(), 1U);
  EXPECT_EQ(Parts().extras.items().front().first, "b");
  EXPECT_EQ(Parts().rcan->timestamp_us, 2);
  for (const metrics::CoreCell& each : server().probe().over_rate_total) {
    EXPECT_EQ(each.value(), &each == &server().probe().over_rate_total[0] ? 0 : 1);
  }
  EXPECT_EQ(server().counts().received, seq_);
}

TEST_F(TelemetryRateTest, OtherKindsAreDecodedWhateverTheRate) {
  SendMotions(kBurst + 5);
  model::SystemHealth health;
  health.device_id = "a";
  Send(schema::Encode(health));
  EXPECT_EQ(Parts().health.items().size(), 1U);
}

TEST_F(TelemetryRateTest, TheLastOneIsAppliedWhereTheStreamBreaks) {
  SendMotions(60);
  stream_->Break();
  EXPECT_EQ(Latitude(), 60);
  EXPECT_EQ(server().counts().received, 60U);
}

TEST_F(TelemetryRateTest, TheLastOneIsAppliedWhereTheAgentHalfCloses) {
  SendMotions(60);
  stream_->HalfClose();
  EXPECT_EQ(stream_->end(), "OK");
  EXPECT_EQ(Latitude(), 60);
  EXPECT_EQ(server().counts().received, 60U);
}

TEST_F(TelemetryRateTest, WhatIsRejectedForItsSizeLeavesNoDebt) {
  const std::string large = Extras(std::string(limits_.session.message_bytes_max, 'k'));
  for (std::size_t i = 0; i < 3 * kBurst; ++i) Send(large);
  ASSERT_EQ(
      server().page()
              .rejected_kinds[static_cast<std::size_t>(model::Variant::kTelemetryExtras)]
                             [static_cast<std::size_t>(model::RejectReason::kPayloadTooLarge)] +
          server().page().rejected_kinds[metrics::kUnknownKind][static_cast<std::size_t>(
              model::RejectReason::kPayloadTooLarge)],
      3 * kBurst);
  clock_.Advance(kPerMessage);
  Send(Motion(7.0));
  EXPECT_EQ(Decoded(), 1U);
  EXPECT_EQ(Latitude(), 7.0);
}

TEST_F(TelemetryRateTest, OneThatIsNotGoodIsSupersededToo) {
  SendMotions(kBurst);
  static_cast<void>(stream_->TakeLines());
  Send(Motion(123));
  server().Pass(kPerMessage);
  EXPECT_EQ(Latitude(), kLastOfBurst);
  EXPECT_EQ(server().counts().superseded, kBurst) << "of the frame all but the last, and this one";
  EXPECT_EQ(server().counts().rejected, 0U);
  EXPECT_THAT(stream_->TakeLines(), IsEmpty());
}

TEST_F(TelemetryRateTest, WhatCannotBeReadIsRejected) {
  SendMotions(kBurst);
  static_cast<void>(stream_->TakeLines());
  Send("x");
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("reject 11 malformed "));
}

TEST_F(TelemetryRateTest, NumbersBeforeOneThatAreMissingAreCounted) {
  SendMotions(kBurst);
  seq_ += 5;
  SendMotions(1);
  server().Commit();
  EXPECT_EQ(server().counts().missing, 5U);
  server().Pass(kPerMessage);
  EXPECT_EQ(server().counts().received, kBurst + 1);
}

TEST_F(TelemetryRateTest, RobotStatesThatWereNotReadAreNotMissing) {
  SendRcan(1);
  SendMotions(kBurst - 1);
  for (int i = 2; i <= 9; ++i) SendRcan(i);
  server().Pass(kPerMessage);
  EXPECT_EQ(Parts().rcan->timestamp_us, 9);
  EXPECT_EQ(server().counts().rcan_missing, 0U);
  server().Pass(10 * kPerMessage);
  SendRcan(12);
  EXPECT_EQ(server().counts().rcan_missing, 2U);
}

TEST_F(TelemetryRateTest, AnOlderRobotStateThatWaitedHidesNoneThatIsMissing) {
  SendRcan(5);
  SendMotions(kBurst - 1);
  SendRcan(3);
  server().Pass(kPerMessage);
  EXPECT_EQ(Parts().rcan->timestamp_us, 5);
  server().Pass(10 * kPerMessage);
  SendRcan(7);
  EXPECT_EQ(server().counts().rcan_missing, 1U) << "the sixth";
}

TEST_F(TelemetryRateTest, AnOlderRobotStateThatWaitedAndCountedOnIsSeenOnce) {
  SendRcan(5);
  SendMotions(kBurst - 1);
  SendRcanState(RcanState(3, 6));
  server().Pass(kPerMessage);
  server().Pass(10 * kPerMessage);
  SendRcan(8);
  EXPECT_EQ(server().counts().rcan_missing, 1U) << "the seventh";
}

TEST_F(TelemetryRateTest, ARobotStateThatWaitedAndIsNotGoodIsNotMissing) {
  SendRcan(1);
  SendMotions(kBurst - 1);
  SendRcanState(R"({"ruri":"rcan://bench/2","timestamp_us":2,"seq":2})");
  server().Pass(kPerMessage);
  server().Pass(10 * kPerMessage);
  SendRcan(3);
  EXPECT_EQ(server().counts().rcan_missing, 0U);
}

TEST_F(TelemetryRateTest, WhatAnotherProcessTookIsNotApplied) {
  SendMotions(60);
  testing::FakeStore other(database_, storage::ProcessId{99});
  const storage::OpenRequest request{
      .robot = server().robot().id(), .session = SessionOf(1), .at = clock_.System()};
  ASSERT_TRUE(other.OpenStreams({&request, 1}).ok());
  Send(Fault());
  server().Commit();
  EXPECT_THAT(stream_->end(), ::testing::StartsWith("ABORTED"));
  EXPECT_EQ(server().counts().received, 61U);
}

TEST_F(TelemetryRateTest, AReloadHoldsFromTheNextMessageOn) {
  SendMotions(60);
  server().allowances().Set({});
  SendMotions(30);
  EXPECT_EQ(Latitude(), 30);
  EXPECT_EQ(Decoded(), kBurst + 30) << "the one that waited is older";
  EXPECT_EQ(server().counts().received, 90U);
}

}  // namespace
}  // namespace uplink::session
