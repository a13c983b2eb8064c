// What durable messages become.
#include "server/cyberwave/records.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::MessageLevel;
using model::MissionStatus;

template <typename T>
T RecordOn(std::string_view tail, std::string_view payload) {
  Judgement judgement = test::JudgeOn(tail, payload);
  const std::optional<DurableRecord> record = TakeRecord(judgement);
  if (!record || !std::holds_alternative<T>(*record)) {
    ADD_FAILURE() << tail << " " << payload;
    return {};
  }
  return std::get<T>(*record);
}

TEST(RecordsTest, AnEventKeepsItsPayloadUnderTheVendorsType) {
  const auto record = RecordOn<EventRecord>(
      "telemetry", R"({"type":"camera_on","timestamp":12.5,"fps":30,"note":null})");
  EXPECT_EQ(record.kind, "cyberwave/camera_on");
  EXPECT_EQ(record.unix_time_ms, 12'500);
  EXPECT_EQ(record.detail_json, R"({"type":"camera_on","timestamp":1.25E1,"fps":30,"note":null})");
  EXPECT_EQ(RecordOn<EventRecord>("event", R"({"event_type":"bumped"})").kind, "cyberwave/bumped");
  EXPECT_EQ(RecordOn<EventRecord>("event", R"({"event_type":"bumped"})").unix_time_ms, 0);
}

TEST(RecordsTest, AMarkIsAnEvent) {
  const auto record =
      RecordOn<EventRecord>("telemetry", R"({"type":"telemetry_end","sensor":"front"})");
  EXPECT_EQ(record.kind, "cyberwave/telemetry_end");
  EXPECT_EQ(record.detail_json, R"({"type":"telemetry_end","sensor":"front"})");
}

TEST(RecordsTest, ALineOfALogIsAMessageWithTheRestAsDetail) {
  const auto record = RecordOn<LogRecord>(
      "driverlog", R"({"message":"slow","level":"Warning","timestamp":1,"container_name":"arm"})");
  EXPECT_EQ(record.message.message, "slow");
  EXPECT_EQ(record.message.level, MessageLevel::kWarn);
  EXPECT_EQ(record.message.unix_time_ms, 1000);
  EXPECT_EQ(record.detail_json, R"({"container_name":"arm","level":"Warning","timestamp":1})");
  EXPECT_EQ(
      RecordOn<LogRecord>("telemetry", R"({"type":"driver_log","message":"m","level":"error"})")
          .message.level,
      MessageLevel::kError);
}

TEST(RecordsTest, EachLevelHasItsSeverity) {
  using enum model::cyberwave::LogLevel;
  EXPECT_EQ(MessageLevelOf(kDebug), MessageLevel::kInfo);
  EXPECT_EQ(MessageLevelOf(kInfo), MessageLevel::kInfo);
  EXPECT_EQ(MessageLevelOf(kUnknown), MessageLevel::kInfo);
  EXPECT_EQ(MessageLevelOf(kWarning), MessageLevel::kWarn);
  EXPECT_EQ(MessageLevelOf(kError), MessageLevel::kError);
  EXPECT_EQ(MessageLevelOf(kCritical), MessageLevel::kError);
}

model::MissionRunStatus Navigation(const std::string& status, const std::string& more = "") {
  return RecordOn<model::MissionRunStatus>(
      "navigate/status", R"({"action_id":"a","status":")" + status + "\"" + more + "}");
}

TEST(RecordsTest, ANavigationIsARunOfItsAction) {
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

TEST(RecordsTest, TheVendorsWordsOfStatusAreOursAndOthersAreKept) {
  EXPECT_EQ(Navigation("queued").status, MissionStatus::kReady);
  EXPECT_EQ(Navigation("completed").status, MissionStatus::kComplete);
  EXPECT_EQ(Navigation("failed").status, MissionStatus::kError);
  EXPECT_EQ(Navigation("cancelled").status, MissionStatus::kAborted);
  EXPECT_EQ(Navigation("dreaming").status, MissionStatus::kUnknown);
  EXPECT_EQ(Navigation("dreaming").status_message, "dreaming");
  EXPECT_EQ(Navigation("dreaming", R"(,"message":"of sheep")").status_message,
            "dreaming: of sheep");
}

TEST(RecordsTest, AMissionIsARunWithItsStep) {
  const auto mission = [](const std::string& step) {
    return RecordOn<model::MissionRunStatus>(
        "mission/status",
        R"({"mission_execution_uuid":"m","status":"running","current_step":)" + step + "}");
  };
  EXPECT_EQ(mission("3").run_id, "m");
  EXPECT_EQ(mission("3").current_step, 3U);
  EXPECT_EQ(mission("4294967296").current_step, std::nullopt) << "no step of ours is so large";
}

TEST(RecordsTest, AChangeOfAScopeStaysAsItIs) {
  const auto record = RecordOn<ScopeRecord>("environment/alert",
                                            R"({"type":"alert","data":{"a":1},"timestamp":3})");
  EXPECT_EQ(record.id.ToText(), test::kEnvironment);
  EXPECT_EQ(record.unix_time_ms, 3000);
  EXPECT_EQ(record.update.type, "alert");
  EXPECT_EQ(record.update.scope, model::cyberwave::ScopeKind::kEnvironment);
  EXPECT_EQ(RecordOn<ScopeRecord>("workflow-run", R"({"status":"done"})").update.scope,
            model::cyberwave::ScopeKind::kWorkflowRun);
}

TEST(RecordsTest, OtherMessagesMakeNone) {
  for (const auto& [tail, payload] : std::vector<std::pair<std::string, std::string>>{
           {"position", R"({"position":{"x":1,"y":2,"z":3}})"},
           {"metrics", R"({"metrics":{"errors":["hot"]}})"},
           {"telemetry", R"({"type":"motor_status"})"},
           {"event", R"({"event_type":"robot_state"})"},
           {"command", R"({"command":"stop"})"},
           {"telemetry", "broken"}}) {
    Judgement judgement = test::JudgeOn(tail, payload);
    EXPECT_FALSE(TakeRecord(judgement).has_value()) << payload;
  }
}

}  // namespace
}  // namespace uplink::cyberwave
