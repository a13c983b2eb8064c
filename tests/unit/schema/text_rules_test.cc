#include <functional>
#include <string>
#include <vector>

#include "schema/json/render.h"
#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::Body;
using model::RejectReason;

/// What a fault in the text does to its message.
enum class Effect { kRejects, kDrops, kCuts };

struct TextCase {
  std::string name;
  std::string field;
  std::size_t bytes_max;
  Effect effect;
  std::function<Body(std::string)> body;
};

/// A case whose text is `member` of a copy of `sample`.
template <typename T>
TextCase Member(const std::string& name, const std::string& field, std::size_t bytes_max,
                Effect effect, T sample, std::function<void(T&, std::string)> set) {
  return {.name = name,
          .field = field,
          .bytes_max = bytes_max,
          .effect = effect,
          .body = [sample, set](std::string text) {
            T body = sample;
            set(body, std::move(text));
            return Body(body);
          }};
}

std::vector<TextCase> LiveCases() {
  using model::ConsumableStatus;
  using model::SpatialDirectiveStatus;
  using model::StatusTelemetry;
  using model::SystemHealth;
  using model::TelemetryExtras;
  using schema::kDescriptionBytesMax;
  using schema::kIdBytesMax;
  using schema::kNameBytesMax;
  return {
      Member<StatusTelemetry>("Status", "status", kDescriptionBytesMax, Effect::kCuts,
                              SampleStatus(), [](auto& b, auto t) { b.status = t; }),
      Member<StatusTelemetry>("VolumeUnit", "fuel.volumeUnit", kNameBytesMax, Effect::kDrops,
                              SampleStatus(), [](auto& b, auto t) { b.fuel->volume_unit = t; }),
      Member<StatusTelemetry>("EfficiencyUnit", "fuel.efficiencyUnit", kNameBytesMax,
                              Effect::kDrops, SampleStatus(),
                              [](auto& b, auto t) { b.fuel->efficiency_unit = t; }),
      Member<StatusTelemetry>("EStopId", "estop.ids[1]", kIdBytesMax, Effect::kDrops,
                              SampleStatus(), [](auto& b, auto t) { b.estop->ids[1] = t; }),
      Member<TelemetryExtras>("ExtrasKey", "kv[1].key", kIdBytesMax, Effect::kDrops, SampleExtras(),
                              [](auto& b, auto t) { b.kv[1].key = t; }),
      Member<TelemetryExtras>("ExtrasString", "kv[3].value", kDescriptionBytesMax, Effect::kDrops,
                              SampleExtras(), [](auto& b, auto t) { b.kv[3].value = t; }),
      Member<TelemetryExtras>("ExtrasEnum", "kv[4].value", kDescriptionBytesMax, Effect::kDrops,
                              SampleExtras(),
                              [](auto& b, auto t) { b.kv[4].value = model::EnumName{t}; }),
      Member<ConsumableStatus>("ConsumableUnit", "unit", kNameBytesMax, Effect::kDrops,
                               SampleConsumable(), [](auto& b, auto t) { b.unit = t; }),
      // Keys of live messages.
      Member<ConsumableStatus>("ConsumableKind", "kind", kIdBytesMax, Effect::kRejects,
                               SampleConsumable(), [](auto& b, auto t) { b.kind = t; }),
      Member<ConsumableStatus>("TankId", "tankId", kIdBytesMax, Effect::kRejects,
                               SampleConsumable(), [](auto& b, auto t) { b.tank_id = t; }),
      Member<SystemHealth>("DeviceId", "deviceId", kIdBytesMax, Effect::kRejects, SampleHealth(),
                           [](auto& b, auto t) { b.device_id = t; }),
      Member<SpatialDirectiveStatus>("DirectiveId", "directiveId", kIdBytesMax, Effect::kRejects,
                                     SampleDirective(),
                                     [](auto& b, auto t) { b.directive_id = t; }),
  };
}

template <typename T>
TextCase Durable(const std::string& name, const std::string& field, std::size_t bytes_max, T sample,
                 std::function<void(T&, std::string)> set) {
  return Member<T>(name, field, bytes_max, Effect::kRejects, std::move(sample), std::move(set));
}

std::vector<TextCase> ReportCases() {
  using model::EventTelemetry;
  using model::Fault;
  using model::MissionRunStatus;
  using schema::kDescriptionBytesMax;
  using schema::kIdBytesMax;
  using schema::kNameBytesMax;
  return {
      Durable<MissionRunStatus>("MissionId", "missionId", kIdBytesMax, SampleMission(),
                                [](auto& b, auto t) { b.mission_id = t; }),
      Durable<MissionRunStatus>("RunId", "runId", kIdBytesMax, SampleMission(),
                                [](auto& b, auto t) { b.run_id = t; }),
      Durable<MissionRunStatus>("StatusMessage", "statusMessage", kDescriptionBytesMax,
                                SampleMission(), [](auto& b, auto t) { b.status_message = t; }),
      Durable<MissionRunStatus>("CurrentPathId", "currentPathId", kIdBytesMax, SampleMission(),
                                [](auto& b, auto t) { b.current_path_id = t; }),
      Durable<MissionRunStatus>("MissionName", "name", kNameBytesMax, SampleMission(),
                                [](auto& b, auto t) { b.name = t; }),
      Durable<Fault>("FaultId", "faultId", kIdBytesMax, SampleFault(),
                     [](auto& b, auto t) { b.fault_id = t; }),
      Durable<Fault>("FaultSource", "source", kNameBytesMax, SampleFault(),
                     [](auto& b, auto t) { b.source = t; }),
      Durable<Fault>("FaultCategory", "category", kNameBytesMax, SampleFault(),
                     [](auto& b, auto t) { b.category = t; }),
      Durable<Fault>("FaultDescription", "description", kDescriptionBytesMax, SampleFault(),
                     [](auto& b, auto t) { b.description = t; }),
      Durable<Fault>("SuggestedAction", "suggestedAction", kDescriptionBytesMax, SampleFault(),
                     [](auto& b, auto t) { b.suggested_action = t; }),
      Durable<EventTelemetry>("RaisedCode", "kind.faultRaised.faultCode", kIdBytesMax,
                              SampleEvent(),
                              [](auto& b, auto t) {
                                b.kind = model::FaultRaisedEvent{t, ""};
                              }),
      Durable<EventTelemetry>("RaisedDescription", "kind.faultRaised.description",
                              kDescriptionBytesMax, SampleEvent(),
                              [](auto& b, auto t) {
                                b.kind = model::FaultRaisedEvent{"E1", t};
                              }),
      Durable<EventTelemetry>("ClearedCode", "kind.faultCleared.faultCode", kIdBytesMax,
                              SampleEvent(),
                              [](auto& b, auto t) { b.kind = model::FaultClearedEvent{t}; }),
      Durable<EventTelemetry>("StartedMission", "kind.missionStarted.missionId", kIdBytesMax,
                              SampleEvent(),
                              [](auto& b, auto t) { b.kind = model::MissionStartedEvent{t}; }),
      Durable<EventTelemetry>("CompletedMission", "kind.missionCompleted.missionId", kIdBytesMax,
                              SampleEvent(),
                              [](auto& b, auto t) { b.kind = model::MissionCompletedEvent{t}; }),
      Durable<model::Message>("MessageText", "message", schema::kMessageTextBytesMax,
                              SampleMessage(), [](auto& b, auto t) { b.message = t; }),
      Durable<model::AgentInfo>("AgentVersion", "agentVersion", kNameBytesMax, SampleAgentInfo(),
                                [](auto& b, auto t) { b.agent_version = t; }),
      Durable<model::AgentInfo>("SoftwareVersion", "softwareVersion", kNameBytesMax,
                                SampleAgentInfo(), [](auto& b, auto t) { b.software_version = t; }),
      Durable<model::AgentInfo>("OsInfo", "osInfo", kNameBytesMax, SampleAgentInfo(),
                                [](auto& b, auto t) { b.os_info = t; }),
  };
}

std::vector<TextCase> SpatialAndUiCases() {
  using model::CurrentSettings;
  using model::Object;
  using model::ReportedShape;
  using model::UiCapabilities;
  using schema::kDescriptionBytesMax;
  using schema::kIdBytesMax;
  using schema::kNameBytesMax;
  const auto shape = [](const std::string& name, const std::string& field, std::size_t max,
                        const std::function<void(ReportedShape&, std::string)>& set) {
    return TextCase{name, field, max, Effect::kRejects, [set](std::string text) {
                      ReportedShape body = SampleShape();
                      set(body, std::move(text));
                      return Body(model::ShapeOp{body});
                    }};
  };
  const auto object = [](const std::string& name, const std::string& field, std::size_t max,
                         const std::function<void(Object&, std::string)>& set) {
    return TextCase{name, field, max, Effect::kRejects, [set](std::string text) {
                      Object body = SampleObject();
                      set(body, std::move(text));
                      return Body(model::ObjectOp{body});
                    }};
  };
  const auto ui = [](const std::string& name, const std::string& field, std::size_t max,
                     std::function<void(UiCapabilities&, std::string)> set) {
    return Durable<UiCapabilities>(name, field, max, SampleCapabilities(), std::move(set));
  };
  return {
      shape("ShapeId", "upsert.identity.id", kIdBytesMax,
            [](auto& b, auto t) { b.identity.id = t; }),
      shape("ShapeName", "upsert.identity.name", kNameBytesMax,
            [](auto& b, auto t) { b.identity.name = t; }),
      shape("ShapeHash", "upsert.identity.hash", kIdBytesMax,
            [](auto& b, auto t) { b.identity.hash = t; }),
      {"ShapeDelete", "delete", kIdBytesMax, Effect::kRejects,
       [](std::string t) { return Body(model::ShapeOp{model::Deletion{std::move(t)}}); }},
      object("ObjectId", "upsert.id", kIdBytesMax, [](auto& b, auto t) { b.id = t; }),
      object("ObjectName", "upsert.name", kNameBytesMax, [](auto& b, auto t) { b.name = t; }),
      {"ObjectDelete", "delete", kIdBytesMax, Effect::kRejects,
       [](std::string t) { return Body(model::ObjectOp{model::Deletion{std::move(t)}}); }},
      ui("ServiceName", "services[0].name", kNameBytesMax,
         [](auto& b, auto t) { b.services[0].name = t; }),
      ui("ServiceDescription", "services[0].description", kDescriptionBytesMax,
         [](auto& b, auto t) { b.services[0].description = t; }),
      ui("Confirmation", "services[0].confirmationMessage", kDescriptionBytesMax,
         [](auto& b, auto t) { b.services[0].confirmation_message = t; }),
      ui("StateKey", "services[0].stateKey", kIdBytesMax,
         [](auto& b, auto t) { b.services[0].state_key = t; }),
      ui("SensorKey", "sensors[0].key", kIdBytesMax, [](auto& b, auto t) { b.sensors[0].key = t; }),
      ui("SensorLabel", "sensors[0].label", kNameBytesMax,
         [](auto& b, auto t) { b.sensors[0].label = t; }),
      ui("SensorUnit", "sensors[0].unit", kNameBytesMax,
         [](auto& b, auto t) { b.sensors[0].unit = t; }),
      ui("SettingKey", "settings[0].key", kIdBytesMax,
         [](auto& b, auto t) { b.settings[0].key = t; }),
      ui("SettingLabel", "settings[0].label", kNameBytesMax,
         [](auto& b, auto t) { b.settings[0].label = t; }),
      Durable<CurrentSettings>("CurrentKey", "[3].key", kIdBytesMax, SampleSettings(),
                               [](auto& b, auto t) { b.settings[3].key = t; }),
      Durable<CurrentSettings>("CurrentString", "[3].value", kDescriptionBytesMax, SampleSettings(),
                               [](auto& b, auto t) { b.settings[3].value = t; }),
  };
}

std::vector<TextCase> AllCases() {
  std::vector<TextCase> cases = LiveCases();
  for (TextCase& text : ReportCases()) cases.push_back(std::move(text));
  for (TextCase& text : SpatialAndUiCases()) cases.push_back(std::move(text));
  return cases;
}

class TextRuleTest : public testing::TestWithParam<TextCase> {
 protected:
  void ExpectFault(const std::string& text, RejectReason reason) const {
    const schema::Judgement judgement = JudgeBody(GetParam().body(text));
    if (GetParam().effect == Effect::kRejects) {
      ExpectRejected(judgement, reason, GetParam().field);
    } else {
      ExpectThinned(judgement, reason, GetParam().field);
    }
  }
  /// Bytes of the good message with this text as JSON.
  static std::size_t RenderedBytes(const std::string& text) {
    const schema::Judgement judgement = JudgeBody(GetParam().body(text));
    ExpectGood(judgement);
    if (judgement.record() == nullptr) return 0;
    return boost::json::serialize(json::RenderBody(judgement.record()->body())).size();
  }
};

TEST_P(TextRuleTest, TakesTextAtTheLimit) {
  ExpectGood(JudgeBody(GetParam().body(std::string(GetParam().bytes_max, 'x'))));
}

TEST_P(TextRuleTest, FaultsTextPastTheLimit) {
  ExpectFault(std::string(GetParam().bytes_max + 1, 'x'), RejectReason::kTextTooLong);
}

TEST_P(TextRuleTest, FaultsWhatIsNotUtf8) {
  ExpectFault("eight ok\xFF", RejectReason::kTextNotUtf8);
  ExpectFault("cut \xC3", RejectReason::kTextNotUtf8);
}

TEST_P(TextRuleTest, FaultsNul) {
  ExpectFault(std::string("NUL\0 in the middle", 18), RejectReason::kTextNotUtf8);
  ExpectFault(std::string("seven..\0", 8), RejectReason::kTextNotUtf8);
}

TEST_P(TextRuleTest, ShowsControlCharactersAsReplacements) {
  // The same message from an agent that wrote the replacements itself.
  const schema::Judgement expected = JudgeBody(GetParam().body("a\t\uFFFDb\r\n\uFFFD\uFFFDc"));
  ExpectGood(expected);
  const schema::Judgement judgement =
      JudgeBody(GetParam().body("a\t\x01"
                                "b\r\n\x7F\u009Bc"));
  ExpectGood(judgement);
  ASSERT_NE(judgement.record(), nullptr);
  EXPECT_EQ(judgement.record()->body(), expected.record()->body());
  EXPECT_EQ(judgement.control_characters, 3U);
  EXPECT_EQ(expected.control_characters, 0U);
}

TEST_P(TextRuleTest, CountsTheBytesThatWereSent) {
  const std::string sent(GetParam().bytes_max, '\x01');
  const schema::Judgement judgement = JudgeBody(GetParam().body(sent));
  ExpectGood(judgement);
  EXPECT_EQ(judgement.control_characters, GetParam().bytes_max);
  ExpectFault(sent + '\x01', RejectReason::kTextTooLong);
  // Three bytes each, and no replacement of ours.
  std::string replacements;
  for (std::size_t i = 0; i <= GetParam().bytes_max / kReplacementBytes; ++i) {
    replacements += "\uFFFD";
  }
  ExpectFault(replacements, RejectReason::kTextTooLong);
}

TEST_P(TextRuleTest, IsRenderedInThreeTimesItsSizeAtMost) {
  const std::size_t bytes = GetParam().bytes_max;
  const std::size_t plain = RenderedBytes(std::string(bytes, 'x'));
  // U+0001 unreplaced would be six bytes each.
  EXPECT_EQ(RenderedBytes(std::string(bytes, '\x01')), plain + 2 * bytes);
  EXPECT_EQ(RenderedBytes(std::string(bytes, '\x7F')), plain + 2 * bytes);
  EXPECT_LE(RenderedBytes(std::string(bytes, '\n')), plain + bytes);
}

TEST_P(TextRuleTest, ComesBackFromACheckpointThoughItGrew) {
  const std::string sent(GetParam().bytes_max, '\x01');
  const schema::Judgement first = JudgeBody(GetParam().body(sent));
  ASSERT_NE(first.record(), nullptr);
  const schema::JudgeLimits kept{.texts = schema::TextForm::kAsKept};
  const schema::Judgement again = JudgeBody(first.record()->body(), kept);
  ExpectGood(again);
  ASSERT_NE(again.record(), nullptr);
  EXPECT_EQ(again.record()->body(), first.record()->body());
  EXPECT_EQ(again.control_characters, 0U);
  const schema::Judgement beyond = JudgeBody(
      GetParam().body(std::string(GetParam().bytes_max * kReplacementBytes + 1, 'x')), kept);
  EXPECT_TRUE(beyond.record() == nullptr || beyond.record()->dropped().size() == 1);
}

INSTANTIATE_TEST_SUITE_P(Fields, TextRuleTest, testing::ValuesIn(AllCases()),
                         [](const auto& test) { return test.param.name; });

TEST(StatusTextTest, IsCutBetweenCodePointsWhenTooLong) {
  model::StatusTelemetry status = SampleStatus();
  // The last code point that would fit straddles the limit.
  status.status = std::string(schema::kDescriptionBytesMax - 1, 'x') + "ü and more";
  const schema::Judgement judgement = JudgeBody(status);
  ExpectThinned(judgement, RejectReason::kTextTooLong, "status");
  EXPECT_EQ(BodyOf<model::StatusTelemetry>(judgement).status,
            std::string(schema::kDescriptionBytesMax - 1, 'x'));
}

TEST(StatusTextTest, IsDroppedWhenTooLongAndNotUtf8) {
  model::StatusTelemetry status = SampleStatus();
  status.status = std::string(schema::kDescriptionBytesMax + 1, '\xFF');
  const schema::Judgement judgement = JudgeBody(status);
  ExpectThinned(judgement, RejectReason::kTextNotUtf8, "status");
  EXPECT_EQ(BodyOf<model::StatusTelemetry>(judgement).status, std::nullopt);
}

TEST(StatusTextTest, CountsWhatTheCutLeavesOfControlCharacters) {
  model::StatusTelemetry status = SampleStatus();
  status.status = "\x01" + std::string(schema::kDescriptionBytesMax - 1, 'x') + "\x02\x03";
  const schema::Judgement judgement = JudgeBody(status);
  ExpectThinned(judgement, RejectReason::kTextTooLong, "status");
  EXPECT_EQ(judgement.control_characters, 1U);
  EXPECT_EQ(BodyOf<model::StatusTelemetry>(judgement).status,
            "\uFFFD" + std::string(schema::kDescriptionBytesMax - 1, 'x'));
}

TEST(ControlCharactersTest, AreNotCountedInWhatIsRejected) {
  model::Fault fault = SampleFault();
  fault.description = "\x01";
  fault.suggested_action = std::string(schema::kDescriptionBytesMax + 1, 'x');
  const schema::Judgement judgement = JudgeBody(fault);
  ExpectRejected(judgement, RejectReason::kTextTooLong, "suggestedAction");
  EXPECT_EQ(judgement.control_characters, 0U);
}

TEST(ControlCharactersTest, KeysThatBecomeTheSameAreTheSame) {
  const std::string replaced = "a\uFFFD";
  model::CurrentSettings settings;
  settings.settings = {{.key = "a\x01", .value = 1.0}, {.key = "a\x02", .value = 2.0}};
  ExpectRejected(JudgeBody(settings), RejectReason::kDuplicateKey, "[1].key");
  settings.settings = {{.key = replaced, .value = 1.0}, {.key = "a\x02", .value = 2.0}};
  ExpectRejected(JudgeBody(settings), RejectReason::kDuplicateKey, "[1].key");
  settings.settings = {{.key = "a\x02", .value = 1.0}, {.key = "ab", .value = 2.0}};
  ExpectGood(JudgeBody(settings));

  model::TelemetryExtras extras = SampleExtras();
  extras.kv = {{.key = "a\x01", .value = 1.0, .unix_time_ms = {}},
               {.key = "a\x02", .value = 2.0, .unix_time_ms = {}}};
  const auto kept = BodyOf<model::TelemetryExtras>(JudgeBody(extras));
  ASSERT_EQ(kept.kv.size(), 1U);
  EXPECT_EQ(kept.kv[0].key, replaced);
  EXPECT_EQ(kept.kv[0].value, model::Value(2.0)) << "the later one wins";
}

}  // namespace
}  // namespace uplink::test
