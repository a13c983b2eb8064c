// What durable messages become: records that stores keep.
#include "schema/cyberwave/records.h"

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::MessageLevel;
using model::MissionStatus;

/// What the message's record says.
template <typename T>
T RecordOn(std::string_view tail, std::string_view payload) {
  Judgement judgement = test::JudgeOn(tail, payload);
  const std::optional<DurableRecord> made = Records::Take(judgement);
  const auto* record = made ? std::get_if<model::Record>(&*made) : nullptr;
  const T* body = record == nullptr ? nullptr : std::get_if<T>(&record->body());
  if (body == nullptr) {
    ADD_FAILURE() << tail << " " << payload;
    return {};
  }
  EXPECT_TRUE(record->durable());
  EXPECT_EQ(record->payload_bytes(), payload.size());
  return *body;
}

struct SaidEvent {
  std::string kind;
  std::string detail;
  std::int64_t unix_time_ms = 0;
};
SaidEvent EventOn(std::string_view tail, std::string_view payload) {
  const auto event = RecordOn<model::EventTelemetry>(tail, payload);
  const auto* foreign = std::get_if<model::NamedEvent>(&event.kind);
  if (foreign == nullptr) return {};
  return {foreign->kind, foreign->detail_json, event.unix_time_ms};
}

TEST(CyberwaveRecords, AnEventKeepsItsPayloadUnderTheVendorsType) {
  const SaidEvent record =
      EventOn("telemetry", R"({"type":"camera_on","timestamp":12.5,"fps":30,"note":null})");
  EXPECT_EQ(record.kind, "cyberwave/camera_on");
  EXPECT_EQ(record.unix_time_ms, 12'500);
  EXPECT_EQ(record.detail, R"({"type":"camera_on","timestamp":1.25E1,"fps":30,"note":null})");
  EXPECT_EQ(EventOn("event", R"({"event_type":"bumped"})").kind, "cyberwave/bumped");
  EXPECT_EQ(EventOn("event", R"({"event_type":"bumped"})").unix_time_ms, 0);
}

TEST(CyberwaveRecords, AMarkIsAnEvent) {
  const SaidEvent record = EventOn("telemetry", R"({"type":"telemetry_end","sensor":"front"})");
  EXPECT_EQ(record.kind, "cyberwave/telemetry_end");
  EXPECT_EQ(record.detail, R"({"type":"telemetry_end","sensor":"front"})");
}

TEST(CyberwaveRecords, ALineOfALogIsAMessageWithTheRestAsDetail) {
  const auto record = RecordOn<model::Message>(
      "driverlog", R"({"message":"slow","level":"Warning","timestamp":1,"container_name":"arm"})");
  EXPECT_EQ(record.message, "slow");
  EXPECT_EQ(record.level, MessageLevel::kWarn);
  EXPECT_EQ(record.unix_time_ms, 1000);
  EXPECT_EQ(record.detail_json, R"({"container_name":"arm","level":"Warning","timestamp":1})");
  EXPECT_EQ(RecordOn<model::Message>("telemetry",
                                     R"({"type":"driver_log","message":"m","level":"error"})")
                .level,
            MessageLevel::kError);
}

TEST(CyberwaveRecords, EachLevelHasItsPlace) {
  for (const auto& [word, level] :
       {std::pair{"debug", MessageLevel::kInfo}, std::pair{"INFO", MessageLevel::kInfo},
        std::pair{"whatever", MessageLevel::kInfo}, std::pair{"warning", MessageLevel::kWarn},
        std::pair{"Error", MessageLevel::kError}, std::pair{"critical", MessageLevel::kError}}) {
    const auto message = RecordOn<model::Message>(
        "driverlog", R"({"message":"m","level":")" + std::string(word) + "\"}");
    EXPECT_EQ(message.level, level) << word;
    EXPECT_EQ(message.unix_time_ms, 0) << "no time was said";
  }
}

model::MissionRunStatus Navigation(const std::string& status, const std::string& more = "") {
  return RecordOn<model::MissionRunStatus>(
      "navigate/status", R"({"action_id":"a","status":")" + status + "\"" + more + "}");
}

TEST(CyberwaveRecords, ANavigationIsARunOfItsAction) {
  const auto good = Navigation("running", R"(,"progress":42.555,"message":"on","timestamp":2)");
  EXPECT_EQ(good.run_id, "a");
  EXPECT_EQ(good.mission_id, "");
  EXPECT_EQ(good.status, MissionStatus::kRunning);
  EXPECT_EQ(good.progress_x100, 4256);
  EXPECT_EQ(good.status_message, "on");
  EXPECT_EQ(good.unix_time_ms, 2000);
  EXPECT_EQ(Navigation("running", R"(,"progress":100)").progress_x100, 10'000);
  EXPECT_EQ(Navigation("running").progress_x100, std::nullopt);
  EXPECT_EQ(Navigation("running").status_message, std::nullopt);
}

TEST(CyberwaveRecords, TheVendorsWordsOfStatusAreOursAndOthersAreKept) {
  EXPECT_EQ(Navigation("queued").status, MissionStatus::kReady);
  EXPECT_EQ(Navigation("completed").status, MissionStatus::kComplete);
  EXPECT_EQ(Navigation("failed").status, MissionStatus::kError);
  EXPECT_EQ(Navigation("cancelled").status, MissionStatus::kAborted);
  EXPECT_EQ(Navigation("dreaming").status, MissionStatus::kUnknown);
  EXPECT_EQ(Navigation("dreaming").status_message, "dreaming");
  EXPECT_EQ(Navigation("dreaming", R"(,"message":"of sheep")").status_message,
            "dreaming: of sheep");
}

TEST(CyberwaveRecords, AMissionIsARunWithItsStep) {
  const auto mission = [](const std::string& step) {
    return RecordOn<model::MissionRunStatus>(
        "mission/status",
        R"({"mission_execution_uuid":"m","status":"running","current_step":)" + step + "}");
  };
  EXPECT_EQ(mission("3").run_id, "m");
  EXPECT_EQ(mission("3").current_step, 3U);
  EXPECT_EQ(mission("4294967296").current_step, std::nullopt) << "no step of ours is so large";
}

TEST(CyberwaveRecords, AnUpdateOfAScopeIsThatOfItsTopicAndOfNoRobot) {
  for (const auto& [topic, payload, scope, type] :
       {std::tuple{"environment/weather", R"({"type":"weather","data":{},"timestamp":2})",
                   model::ScopeKind::kEnvironment, "weather"},
        std::tuple{"workflow-run", R"({"status":"running","timestamp":2})",
                   model::ScopeKind::kWorkflowRun, "running"}}) {
    Judgement judgement = test::JudgeOn(topic, payload);
    const std::optional<DurableRecord> made = Records::Take(judgement);
    ASSERT_TRUE(made);
    const auto& update = std::get<model::ScopeUpdate>(*made);
    EXPECT_EQ(update.scope, scope);
    EXPECT_EQ(update.id, test::kEnvironment);
    EXPECT_EQ(update.type, type);
    EXPECT_EQ(update.unix_time_ms, 2'000);
    EXPECT_NE(update.detail_json.find(type), std::string::npos);
  }
}

TEST(CyberwaveRecords, AFaultIsARecordOfItsMessage) {
  model::Fault fault;
  fault.fault_id = "hot";
  const DurableRecord made = Records::Of(fault, 77);
  const auto& record = std::get<model::Record>(made);
  EXPECT_EQ(std::get<model::Fault>(record.body()), fault);
  EXPECT_EQ(record.payload_bytes(), 77U);
}

TEST(CyberwaveRecords, OtherMessagesMakeNone) {
  for (const auto& [tail, payload] : std::vector<std::pair<std::string, std::string>>{
           {"position", R"({"position":{"x":1,"y":2,"z":3}})"},
           {"metrics", R"({"metrics":{"errors":["hot"]}})"},
           {"telemetry", R"({"type":"motor_status"})"},
           {"event", R"({"event_type":"robot_state"})"},
           {"command", R"({"command":"stop"})"},
           {"telemetry", "broken"}}) {
    Judgement judgement = test::JudgeOn(tail, payload);
    EXPECT_FALSE(Records::Take(judgement).has_value()) << payload;
  }
}

TEST(CyberwaveRecords, ScopesHaveTextsThatLeadBack) {
  for (const model::ScopeKind kind :
       {model::ScopeKind::kEnvironment, model::ScopeKind::kWorkflowRun}) {
    EXPECT_EQ(model::ScopeKindFromText(ToText(kind)), kind);
  }
  EXPECT_FALSE(model::ScopeKindFromText("workflow-run"));
  EXPECT_FALSE(model::ScopeKindFromText(""));
}

}  // namespace
}  // namespace uplink::cyberwave
