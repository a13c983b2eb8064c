// What becomes of each message of a broker.
#include "server/broker/intake.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Processed = Intake::Processed;

constexpr const char* kPosition = R"({"source_type":"edge","position":{"x":1,"y":2,"z":3}})";

class IntakeTest : public ::testing::Test {
 protected:
  IntakeTest() { EXPECT_TRUE(bench_.TakeLease()); }
  ~IntakeTest() override {
    EXPECT_TRUE(bench_.ledger.Read().messages.Balanced());
    EXPECT_EQ(bench_.uplinks.Read().messages.received, 0U) << "these are the relay's counts";
    EXPECT_EQ(bench_.uplinks.Read().messages.in_flight, 0);
    EXPECT_TRUE(bench_.uplinks.Read().messages.Balanced());
  }
  std::vector<storage::EventRow> Events() { return bench_.store.Events({})->rows; }
  std::vector<storage::QuarantineRow> Quarantine() { return bench_.store.Quarantine({})->rows; }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1};
};

TEST_F(IntakeTest, ADurableMessageIsAckedOnceItIsCommitted) {
  EXPECT_EQ(bench_.Publish(Bench::Of("telemetry"), Bench::Event(1), {.id = 5, .handle = 11}),
            Processed::kDone);
  EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 1);
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  ASSERT_THAT(Events(), SizeIs(1));
  EXPECT_EQ(Events()[0].robot.ruri, RuriOf(kTwin));
  EXPECT_EQ(Events()[0].robot.fleet, "arms");
}

TEST_F(IntakeTest, ALiveMessageIsAppliedAndAckedAtOnce) {
  EXPECT_EQ(bench_.Publish(Bench::Of("position"), kPosition, {.id = 5, .handle = 11}),
            Processed::kDone);
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kApplied), 1U);
  bench_.twins.Find(RuriOf(kTwin))->LookAt([](const cyberwave::TwinParts& parts) {
    EXPECT_EQ(parts.position->value.y_m, 2);
  });
  EXPECT_EQ(bench_.PresenceOf(RuriOf(kTwin)), robot::Presence::kOnline);
}

TEST_F(IntakeTest, LateStateIsSuperseded) {
  const auto at = [](int second) {
    return R"({"position":{"x":1,"y":2,"z":3},"session_id":"a","timestamp":)" +
           std::to_string(1'763'683'200 + second) + "}";
  };
  (void)bench_.Publish(Bench::Of("position"), at(5));
  (void)bench_.Publish(Bench::Of("position"), at(4));
  EXPECT_EQ(bench_.Count(Became::kApplied), 1U);
  EXPECT_EQ(bench_.Count(Became::kSuperseded), 1U);
}

TEST_F(IntakeTest, ARejectedMessageIsAckedOnceItsRowOfQuarantineIsCommitted) {
  (void)bench_.Publish(Bench::Of("position"), kPosition);
  (void)bench_.Publish(Bench::Of("telemetry"), "{", {.id = 5, .handle = 11});
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kRejected), 1U);
  ASSERT_THAT(Quarantine(), SizeIs(1));
  EXPECT_EQ(Quarantine()[0].robot.ruri, RuriOf(kTwin));
  EXPECT_EQ(Quarantine()[0].payload, "{");
  EXPECT_EQ(Quarantine()[0].topic, Bench::Of("telemetry"));
}

TEST_F(IntakeTest, WhatProvesNoTwinLiesInQuarantineUnderNoRobot) {
  (void)bench_.Publish(Bench::Of("telemetry"), "{", {.id = 5, .handle = 11});
  (void)bench_.Publish("cyberwave/twin/none/telemetry", "{}", {.id = 6, .handle = 12});
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
  EXPECT_THAT(Quarantine(), SizeIs(2));
  EXPECT_EQ(bench_.fleet.size(), 0U);
}

TEST_F(IntakeTest, SecretsStandInNoRow) {
  (void)bench_.Publish("cyberwave/twin/none/webrtc-offer", R"({"sdp":"SECRET"})",
                       {.id = 5, .handle = 11});
  (void)bench_.Publish(Bench::Of("command"), R"([{"password":"SECRET"}])");
  bench_.Run();
  for (const storage::QuarantineRow& row : Quarantine()) {
    EXPECT_EQ(row.payload, "");
    EXPECT_EQ(row.topic.find("SECRET"), std::string::npos);
    EXPECT_EQ(row.rejection.detail.find("SECRET"), std::string::npos);
  }
}

TEST_F(IntakeTest, ScopesBelongToNoRobot) {
  (void)bench_.Publish(std::string("cyberwave/environment/") + kTwin + "/joined",
                       R"({"type":"joined","data":{"who":"a"}})", {.id = 5, .handle = 11});
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  EXPECT_THAT(bench_.store.ScopeUpdates({})->rows, SizeIs(1));
  EXPECT_EQ(bench_.fleet.size(), 0U);
}

TEST_F(IntakeTest, RetainedAndUnknownOnesAreIgnored) {
  (void)bench_.Publish(Bench::Of("position"), kPosition, {.id = 5, .retained = true, .handle = 11});
  (void)bench_.Publish(Bench::Of("nothing"), "{}", {.id = 6, .handle = 12});
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
  EXPECT_EQ(bench_.Count(Became::kIgnored), 2U);
  EXPECT_EQ(bench_.fleet.size(), 0U) << "a retained message fakes life";
}

TEST_F(IntakeTest, WhoCommandsATwinDoesNotMakeItExist) {
  (void)bench_.Publish(Bench::Of("command"), R"({"command":"move"})");
  (void)bench_.Publish(Bench::Of("position"),
                       R"({"source_type":"tele","position":{"x":1,"y":2,"z":3}})");
  EXPECT_EQ(bench_.Count(Became::kObserved), 2U);
  EXPECT_EQ(bench_.fleet.size(), 0U);
  (void)bench_.Publish(Bench::Of("position"), kPosition);
  (void)bench_.Publish(Bench::Of("command"), R"({"command":"move"})");
  bench_.twins.Find(RuriOf(kTwin))->LookAt([](const cyberwave::TwinParts& parts) {
    EXPECT_EQ(parts.observed.observed(cyberwave::TopicKind::kCommand), 1U);
  });
}

TEST_F(IntakeTest, MarksMakeARobotAndNoLife) {
  (void)bench_.Publish(Bench::Of("telemetry"), R"({"type":"connected"})", {.id = 5, .handle = 11});
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  EXPECT_EQ(bench_.PresenceOf(RuriOf(kTwin)), robot::Presence::kUnknown);
}

TEST_F(IntakeTest, ASimulationIsARobotOfItsOwn) {
  (void)bench_.Publish(Bench::Of("position"), kPosition);
  (void)bench_.Publish(Bench::Of("position"),
                       R"({"source_type":"sim","position":{"x":9,"y":2,"z":3}})");
  EXPECT_EQ(bench_.fleet.size(), 2U);
  EXPECT_NE(bench_.twins.Find(RuriOf(kTwin, "sim")), nullptr);
}

TEST_F(IntakeTest, ErrorsOfMetricsAreCommittedTogether) {
  (void)bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"errors":["a","b","c"]}})",
                       {.id = 5, .handle = 11});
  bench_.Write();
  EXPECT_EQ(bench_.Count(Became::kStored), 0U);
  bench_.Look();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kStored), 1U) << "one message";
  EXPECT_THAT(bench_.store.FaultsActive({})->rows, SizeIs(3));
  (void)bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"load":{"cpu":1}}})",
                       {.id = 6, .handle = 12});
  bench_.Run();
  EXPECT_THAT(bench_.store.FaultsActive({})->rows, IsEmpty());
}

TEST_F(IntakeTest, FaultsOfAnEarlierLifeAreClearedByTheNextMetrics) {
  (void)bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"errors":["a"]}})");
  bench_.Run();
  Bench next(database_, 2);
  next.streams.SetFaults({{RuriOf(kTwin), {"a"}}});
  ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
  (void)next.Publish(Bench::Of("metrics"), R"({"metrics":{"load":{"cpu":1}}})");
  next.Run();
  EXPECT_THAT(next.store.FaultsActive({})->rows, IsEmpty());
}

TEST_F(IntakeTest, APingIsAnsweredUnderItsPrefixWithItsCorrelation) {
  mqtt::Message ping;
  ping.publish.topic = "site/a/cyberwave/ping/Arm 1/request";
  ping.publish.payload = R"({"type":"ping"})";
  ping.publish.correlation = "c";
  (void)bench_.intake.Process(ping, {bench_.clock.Steady(), bench_.clock.System()});
  ASSERT_THAT(bench_.published, SizeIs(1));
  EXPECT_EQ(bench_.published[0].topic, "site/a/cyberwave/pong/Arm 1/response");
  EXPECT_EQ(bench_.published[0].correlation, "c");
  EXPECT_EQ(bench_.Count(Became::kObserved), 1U);
  for (int i = 0; i < 20; ++i)
    (void)bench_.intake.Process(ping, {bench_.clock.Steady(), bench_.clock.System()});
  EXPECT_THAT(bench_.published, SizeIs(10)) << "in any second";
  EXPECT_EQ(bench_.probe.pongs_withheld.value(), 11);
}

TEST_F(IntakeTest, ATwinPastItsRateIsRejectedAndNotQuarantined) {
  for (int i = 0; i < 5'001; ++i) (void)bench_.Publish(Bench::Of("position"), kPosition);
  EXPECT_EQ(bench_.Count(Became::kApplied), 5'000U);
  EXPECT_EQ(bench_.Count(Became::kRejected), 1U);
  (void)bench_.Publish(Bench::Of("position", kOtherTwin), kPosition);
  EXPECT_EQ(bench_.Count(Became::kApplied), 5'001U) << "one robot costs only itself";
  bench_.Run();
  EXPECT_THAT(Quarantine(), IsEmpty());
}

class FullIntakeTest : public ::testing::Test {
 protected:
  FullIntakeTest() {
    EXPECT_TRUE(bench_.TakeLease());
    (void)bench_.Publish(Bench::Of("position"), kPosition);
    bench_.Run();
    (void)bench_.Publish(Bench::Of("telemetry"), Bench::Event(1), {.id = 1, .handle = 11});
  }
  static BenchLimits OneRecord() {
    BenchLimits limits;
    limits.journal.records_max = 1;
    return limits;
  }
  testing::FakeDatabase database_;
  Bench bench_{database_, 1, OneRecord()};
};

TEST_F(FullIntakeTest, AtQos1WaitsUnackedUntilThereIsRoom) {
  const std::string topic = Bench::Of("telemetry");
  const std::string payload = Bench::Event(2);
  mqtt::Message message;
  message.publish.topic = topic;
  message.publish.payload = payload;
  message.publish.payload_bytes = payload.size();
  message.publish.id = 2;
  message.publish.qos = mqtt::Qos::kAtLeastOnce;
  message.ack = mqtt::AckHandle{1, 12};
  const cyberwave::Arrival arrived{bench_.clock.Steady(), bench_.clock.System()};
  ASSERT_EQ(bench_.intake.Process(message, arrived), Processed::kHeldBack);
  const HeldBackMessage held(message, arrived);
  EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 2);
  EXPECT_TRUE(bench_.ledger.Read().messages.Balanced());
  EXPECT_EQ(bench_.intake.ProcessHeldBack(held), Processed::kHeldBack);
  EXPECT_EQ(bench_.ledger.Read().messages.received, 3U) << "each message once";
  EXPECT_EQ(bench_.probe.held_back_total.value(), 1);
  bench_.Run();
  bench_.clock.Advance(std::chrono::seconds(5));
  EXPECT_EQ(bench_.intake.ProcessHeldBack(held), Processed::kDone);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U));
  EXPECT_TRUE(bench_.ledger.Read().messages.Balanced());
  EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 0);
  EXPECT_EQ(bench_.store.Events({})->rows.front().received_at, arrived.system)
      << "not when room came";
}

TEST_F(FullIntakeTest, WhoIsRefusedIsHeardAllTheSame) {
  bench_.clock.Advance(std::chrono::seconds(19));
  EXPECT_EQ(bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"errors":["a"]}})"),
            Processed::kDone);
  EXPECT_EQ(bench_.Count(Became::kRefused), 1U);
  bench_.clock.Advance(std::chrono::seconds(19));
  static_cast<void>(bench_.fleet.Sweep(std::chrono::hours(1)));
  EXPECT_EQ(bench_.PresenceOf(RuriOf(kTwin)), robot::Presence::kOnline);
}

TEST_F(FullIntakeTest, MetricsThatChangeNoFaultAreLiveState) {
  EXPECT_EQ(bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"load":{"cpu":1}}})"),
            Processed::kDone);
  EXPECT_EQ(bench_.Count(Became::kApplied), 2U);
}

TEST_F(FullIntakeTest, AtQos0IsRefusedAndCounted) {
  EXPECT_EQ(bench_.Publish(Bench::Of("telemetry"), Bench::Event(2)), Processed::kDone);
  EXPECT_EQ(bench_.Count(Became::kRefused), 1U);
}

TEST_F(FullIntakeTest, LiveStateAndPongsGoOn) {
  EXPECT_EQ(bench_.Publish(Bench::Of("position"), kPosition), Processed::kDone);
  EXPECT_EQ(bench_.Publish("cyberwave/ping/a/request", R"({"type":"ping"})"), Processed::kDone);
  EXPECT_EQ(bench_.Count(Became::kApplied), 2U);
  EXPECT_THAT(bench_.published, SizeIs(1));
}

TEST_F(FullIntakeTest, AHeldOneThatComesNoMoreIsRefused) {
  (void)bench_.Publish(Bench::Of("telemetry"), Bench::Event(2), {.id = 2, .handle = 12});
  bench_.intake.DropHeldBack();
  EXPECT_EQ(bench_.Count(Became::kRefused), 1U);
  EXPECT_TRUE(bench_.ledger.Read().messages.Balanced());
  EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 1);
}

TEST(IntakePastItsRobots, DurableMessagesOfOneMoreLieInQuarantineAndLiveOnesAreRefused) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.twins_max = 1});
  ASSERT_TRUE(bench.TakeLease());
  (void)bench.Publish(Bench::Of("position"), kPosition);
  (void)bench.Publish(Bench::Of("position", kOtherTwin), kPosition);
  EXPECT_EQ(bench.Count(Became::kRefused), 1U);
  (void)bench.Publish(Bench::Of("telemetry", kOtherTwin), Bench::Event(1), {.id = 1, .handle = 11});
  bench.Run();
  EXPECT_THAT(bench.Acked(), ElementsAre(11U));
  ASSERT_THAT(bench.store.Quarantine({})->rows, SizeIs(1));
  EXPECT_EQ(bench.store.Quarantine({})->rows[0].rejection.reason,
            model::RejectReason::kTooManyItems);
  EXPECT_EQ(bench.probe.twins_refused.value(), 2);
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
}

}  // namespace
}  // namespace uplink::broker
