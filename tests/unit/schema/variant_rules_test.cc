#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::RejectReason;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();

TEST(SamplesTest, AreGoodAndComeBackAsTheyWere) {
  for (const model::Body& body : SampleBodies()) {
    SCOPED_TRACE(model::ToText(model::VariantOf(body)));
    const schema::Judgement judgement = JudgeBody(body);
    ExpectGood(judgement);
    EXPECT_TRUE(judgement.record()->body() == body);
    EXPECT_EQ(judgement.variant, model::VariantOf(body));
    EXPECT_EQ(judgement.record()->payload_bytes(), schema::Encode(body).size());
  }
}

TEST(SignOfLifeTest, ComesFromMotionAndStatusOnly) {
  for (const model::Body& body : SampleBodies()) {
    const model::Variant variant = model::VariantOf(body);
    EXPECT_EQ(JudgeBody(body).sign_of_life, variant == model::Variant::kMotionTelemetry ||
                                                variant == model::Variant::kStatusTelemetry)
        << model::ToText(variant);
  }
}

TEST(MotionTest, IsRejectedWhenNothingOfItIsLeft) {
  model::MotionTelemetry motion = SampleMotion();
  motion.gps_fix_type.reset();
  motion.pose->lat_deg = 91;
  motion.velocity = model::VelTwist{.linear_mps = 1001, .angular_rps = kInfF};
  const schema::Judgement judgement = JudgeBody(motion);
  ExpectRejected(judgement, RejectReason::kOutOfRange, "pose.latDeg");
  EXPECT_TRUE(judgement.sign_of_life);
}

TEST(MotionTest, IsAppliedForItsVelocityAlone) {
  model::MotionTelemetry motion = SampleMotion();
  motion.gps_fix_type.reset();
  motion.pose->lat_deg = 91;
  ExpectThinned(JudgeBody(motion), RejectReason::kOutOfRange, "pose.latDeg");
}

TEST(MotionTest, IsAppliedWhenItCameEmpty) {
  ExpectGood(JudgeBody(model::MotionTelemetry{.unix_time_ms = kSampleMs}));
}

TEST(StatusTest, KeepsItsEStopBesideAnAbsurdBattery) {
  model::StatusTelemetry status = SampleStatus();
  status.battery->soc_pct = -400;
  const schema::Judgement judgement = JudgeBody(status);
  ExpectThinned(judgement, RejectReason::kOutOfRange, "battery.socPct");
  const auto judged = BodyOf<model::StatusTelemetry>(judgement);
  EXPECT_EQ(judged.battery->soc_pct, std::nullopt);
  EXPECT_EQ(judged.battery->voltage_v, 48.0F);
  EXPECT_TRUE(judged.estop->active);
}

TEST(StatusTest, HasUpToThirtyTwoEStopIds) {
  model::StatusTelemetry status = SampleStatus();
  status.estop->ids.assign(schema::kEStopIdsMax, "stop");
  ExpectGood(JudgeBody(status));
  status.estop->ids.emplace_back("one more");
  const schema::Judgement judgement = JudgeBody(status);
  ExpectRejected(judgement, RejectReason::kTooManyItems, "estop.ids");
  EXPECT_TRUE(judgement.sign_of_life);
}

TEST(ExtrasTest, AreBoundedByTheConfiguredCount) {
  model::TelemetryExtras extras;
  for (int i = 0; i < 256; ++i) {
    extras.kv.push_back({.key = "k" + std::to_string(i), .value = i, .unix_time_ms = {}});
  }
  ExpectGood(JudgeBody(extras));
  ExpectRejected(JudgeBody(extras, {.extras_items_max = 255}), RejectReason::kTooManyItems, "kv");
  extras.kv.push_back({.key = "k256", .value = 1.0, .unix_time_ms = {}});
  ExpectRejected(JudgeBody(extras), RejectReason::kTooManyItems, "kv");
  ExpectGood(JudgeBody(extras, {.extras_items_max = 257}));
}

TEST(ExtrasTest, KeepTheLaterOfTwoReadingsWithOneKey) {
  for (const int readings : {3, 100}) {  // scanned, and indexed
    model::TelemetryExtras extras;
    for (int i = 0; i < readings; ++i) {
      extras.kv.push_back({.key = "k" + std::to_string(i), .value = i, .unix_time_ms = {}});
    }
    extras.kv.push_back({.key = "k1", .value = 64.5, .unix_time_ms = kSampleMs});
    const schema::Judgement judgement = JudgeBody(extras);
    ExpectGood(judgement);
    const auto judged = BodyOf<model::TelemetryExtras>(judgement);
    ASSERT_EQ(judged.kv.size(), static_cast<std::size_t>(readings));
    EXPECT_EQ(judged.kv[1].value, model::Value(64.5));
    EXPECT_EQ(judged.kv[1].unix_time_ms, kSampleMs);
  }
}

TEST(ExtrasTest, DropAReadingWithoutKey) {
  model::TelemetryExtras extras = SampleExtras();
  extras.kv[2].key.clear();
  const schema::Judgement judgement = JudgeBody(extras);
  ExpectThinned(judgement, RejectReason::kMissingField, "kv[2].key");
  EXPECT_EQ(BodyOf<model::TelemetryExtras>(judgement).kv.size(), 4U);
}

TEST(ExtrasTest, AreRejectedWhenEveryReadingIsAtFault) {
  model::TelemetryExtras extras;
  extras.kv = {{.key = "a", .value = kNan, .unix_time_ms = {}},
               {.key = "", .value = 1.0, .unix_time_ms = {}}};
  ExpectRejected(JudgeBody(extras), RejectReason::kNotFinite, "kv[0].value");
}

TEST(ExtrasTest, AreAppliedWhenTheyCameEmpty) {
  ExpectGood(JudgeBody(model::TelemetryExtras{.unix_time_ms = kSampleMs, .kv = {}}));
}

TEST(HealthTest, IsRejectedWhenEveryNumberIsAtFault) {
  model::SystemHealth health = SampleHealth();
  health.cpu_pct = health.mem_pct = health.disk_pct = 200;
  health.cpu_temp = health.signal_strength = health.signal_quality = kInfF;
  ExpectRejected(JudgeBody(health), RejectReason::kOutOfRange, "cpuPct");
  health.signal_quality = 0.5F;
  EXPECT_EQ(JudgeBody(health).record()->dropped().size(), 5U);
}

TEST(HealthTest, IsAppliedWhenNothingWasMeasured) {
  ExpectGood(JudgeBody(model::SystemHealth{.unix_time_ms = kSampleMs, .device_id = "cpu1"}));
}

TEST(LiveKeyTest, MustBeThereWhereARuleSaysSo) {
  model::ConsumableStatus consumable = SampleConsumable();
  consumable.tank_id.clear();
  ExpectGood(JudgeBody(consumable));
  consumable.kind.clear();
  ExpectRejected(JudgeBody(consumable), RejectReason::kMissingField, "kind");
  model::SpatialDirectiveStatus directive = SampleDirective();
  directive.directive_id.clear();
  ExpectRejected(JudgeBody(directive), RejectReason::kMissingField, "directiveId");
  model::SystemHealth health = SampleHealth();
  health.device_id.clear();
  ExpectGood(JudgeBody(health));
}

TEST(MissionTest, NeedsARunButNoMission) {
  model::MissionRunStatus mission = SampleMission();
  mission.mission_id.clear();
  ExpectGood(JudgeBody(mission));
  mission.run_id.clear();
  ExpectRejected(JudgeBody(mission), RejectReason::kMissingField, "runId");
}

TEST(MissionTest, ProgressEndsAtTenThousand) {
  model::MissionRunStatus mission = SampleMission();
  mission.progress_x100 = 10'000;
  ExpectGood(JudgeBody(mission));
  mission.progress_x100 = 10'001;
  ExpectRejected(JudgeBody(mission), RejectReason::kOutOfRange, "progressX100");
}

TEST(ReportTest, NeedsItsIdAndItsText) {
  model::Fault fault = SampleFault();
  fault.fault_id.clear();
  ExpectRejected(JudgeBody(fault), RejectReason::kMissingField, "faultId");
  model::Message message = SampleMessage();
  message.message.clear();
  ExpectRejected(JudgeBody(message), RejectReason::kMissingField, "message");
}

TEST(EventTest, TakesEveryKind) {
  const std::vector<model::EventKind> kinds = {
      model::EstopEngagedEvent{},
      model::EstopReleasedEvent{},
      model::ModeChangedEvent{model::RobotMode::kAuto, model::RobotMode::kIdle},
      model::MissionStartedEvent{"m"},
      model::MissionCompletedEvent{"m"},
      model::FaultRaisedEvent{"E1", "hot"},
      model::FaultClearedEvent{"E1"}};
  ASSERT_EQ(kinds.size() + 1, std::variant_size_v<model::EventKind>) << "and the named one";
  for (const model::EventKind& kind : kinds) {
    const model::EventTelemetry event{.unix_time_ms = kSampleMs, .kind = kind};
    EXPECT_TRUE(BodyOf<model::EventTelemetry>(JudgeBody(event)) == event);
  }
}

TEST(EventTest, OfTheWireIsNeverANamedOne) {
  const model::EventTelemetry event{.unix_time_ms = kSampleMs,
                                    .kind = model::NamedEvent{"cyberwave/connected", "{}"}};
  ExpectRejected(JudgeBody(event), RejectReason::kMissingField, "kind");
}

TEST(EventTest, NeedsItsIds) {
  const auto rejects = [](const model::EventKind& kind, const std::string& field) {
    ExpectRejected(JudgeBody(model::EventTelemetry{.unix_time_ms = 0, .kind = kind}),
                   RejectReason::kMissingField, field);
  };
  rejects(model::MissionStartedEvent{}, "kind.missionStarted.missionId");
  rejects(model::MissionCompletedEvent{}, "kind.missionCompleted.missionId");
  rejects(model::FaultRaisedEvent{}, "kind.faultRaised.faultCode");
  rejects(model::FaultClearedEvent{}, "kind.faultCleared.faultCode");
}

TEST(OperationTest, NeedsItsId) {
  model::ReportedShape shape = SampleShape();
  shape.identity.id.clear();
  ExpectRejected(JudgeBody(model::ShapeOp{shape}), RejectReason::kMissingField,
                 "upsert.identity.id");
  ExpectRejected(JudgeBody(model::ShapeOp{model::Deletion{}}), RejectReason::kMissingField,
                 "delete");
  model::Object object = SampleObject();
  object.id.clear();
  ExpectRejected(JudgeBody(model::ObjectOp{object}), RejectReason::kMissingField, "upsert.id");
  ExpectRejected(JudgeBody(model::ObjectOp{model::Deletion{}}), RejectReason::kMissingField,
                 "delete");
  ExpectGood(JudgeBody(model::ShapeOp{model::Deletion{"s"}}));
  ExpectGood(JudgeBody(model::ObjectOp{model::Deletion{"o"}}));
}

TEST(OperationTest, IsJudgedWithoutRegardToExpiry) {
  model::Object object = SampleObject();
  object.expires_unix_time_ms = 1;
  ExpectGood(JudgeBody(model::ObjectOp{object}));
}

TEST(EnumTest, KeepsAndCountsNumbersWeDoNotKnow) {
  model::StatusTelemetry status = SampleStatus();
  status.mode = static_cast<model::RobotMode>(4);
  status.battery->power_supply_health = static_cast<model::PowerSupplyHealth>(65'535);
  const schema::Judgement judgement = JudgeBody(status);
  ExpectGood(judgement);
  EXPECT_EQ(judgement.enumerants_unrecognized, 2U);
  const auto judged = BodyOf<model::StatusTelemetry>(judgement);
  EXPECT_EQ(model::EnumText(*judged.mode), "unrecognized_4");
  EXPECT_EQ(model::EnumText(judged.battery->power_supply_health), "unrecognized_65535");
}

}  // namespace
}  // namespace uplink::test
