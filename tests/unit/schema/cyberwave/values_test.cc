// What good messages become.
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "schema/cyberwave/limits.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::MissionStatus;
using model::cyberwave::BatteryStatus;
using model::cyberwave::CommandHead;
using model::cyberwave::EdgeHealth;
using model::cyberwave::EdgeStream;
using model::cyberwave::Gps;
using model::cyberwave::Ignored;
using model::cyberwave::Media;
using model::cyberwave::Metric;
using model::cyberwave::Metrics;
using model::cyberwave::MetricValue;
using model::cyberwave::Ping;
using model::cyberwave::Position;
using model::cyberwave::Rotation;
using model::cyberwave::RunStatus;
using model::cyberwave::Scale;
using model::cyberwave::ScopeKind;
using model::cyberwave::ScopeUpdate;
using model::cyberwave::Signalling;
using test::BodyOf;
using test::JudgeOn;
using test::TopicOf;

TEST(CyberwaveValues, PositionAndScale) {
  EXPECT_EQ(BodyOf<Position>(JudgeOn("position", R"({"position":{"x":1,"y":-2.5,"z":0,"w":9}})")),
            (Position{.x_m = 1, .y_m = -2.5, .z_m = 0}));
  EXPECT_EQ(BodyOf<Scale>(JudgeOn("scale", R"({"scale":{"x":1,"y":2,"z":0}})")),
            (Scale{.x = 1, .y = 2, .z = 0}));
}

TEST(CyberwaveValues, RotationTakesWhatIsAbsentFromNoRotation) {
  const auto rotation = [](const std::string& parts) {
    return BodyOf<Rotation>(JudgeOn("rotation", R"({"rotation":{)" + parts + "}}"));
  };
  EXPECT_EQ(rotation(R"("w":0.5,"x":0.1,"y":0.2,"z":0.3)"),
            (Rotation{.w = 0.5, .x = 0.1, .y = 0.2, .z = 0.3}));
  EXPECT_EQ(rotation(R"("z":1)"), (Rotation{.w = 1, .x = 0, .y = 0, .z = 1}));
  EXPECT_EQ(rotation(R"("w":0,"z":1)"), (Rotation{.w = 0, .x = 0, .y = 0, .z = 1}));
  EXPECT_EQ(rotation(R"("w":0,"x":0,"y":0,"z":0)"), Rotation());
  EXPECT_EQ(rotation(R"("w":0)"), Rotation());
}

TEST(CyberwaveValues, Gps) {
  const Gps gps = BodyOf<Gps>(
      JudgeOn("gps", R"({"latitude":47.25,"longitude":8.5,"altitude":412.5,"compass_heading":-90,)"
                     R"("horizontal_accuracy":0.02,"vertical_accuracy":0.03,"satellite_count":12,)"
                     R"("signal_level":4,"fix_type":"rtk_fixed"})"));
  EXPECT_EQ(gps, (Gps{.latitude_deg = 47.25,
                      .longitude_deg = 8.5,
                      .altitude_m = 412.5,
                      .compass_heading_deg = 270,
                      .horizontal_accuracy_m = 0.02,
                      .vertical_accuracy_m = 0.03,
                      .satellite_count = 12,
                      .signal_level = 4,
                      .fix_type = "rtk_fixed"}));
}

TEST(CyberwaveValues, AnInvalidLatitudeTakesThePlaceWithItAndNothingElse) {
  const Gps gps = BodyOf<Gps>(
      JudgeOn("gps", R"({"latitude":91,"longitude":8.5,"altitude":1,"fix_type":"3d"})"));
  EXPECT_EQ(gps, (Gps{.altitude_m = 1, .fix_type = "3d"}));
}

TEST(CyberwaveValues, BatteryClampsNoise) {
  const auto battery = [](const std::string& members) {
    return BodyOf<BatteryStatus>(JudgeOn("battery/status", "{" + members + "}"));
  };
  EXPECT_EQ(battery(R"("percentage":78,"voltage":48.5,"charging":false)"),
            (BatteryStatus{.percentage = 78, .voltage_v = 48.5, .charging = false}));
  EXPECT_EQ(battery(R"("percentage":103)").percentage, 100);
  EXPECT_EQ(battery(R"("percentage":-0.1)").percentage, 0);
  EXPECT_EQ(battery(R"("percentage":0.78)").percentage, 0.78);
  EXPECT_EQ(battery(R"("percentage":null)"), BatteryStatus());
}

TEST(CyberwaveValues, MetricsByCategoryAndName) {
  const Metrics metrics = BodyOf<Metrics>(
      JudgeOn("metrics",
              R"({"metrics":{"power":{"battery_percent":103,"charging":false,"cells":[3.5,null]},)"
              R"("navigation":{"status":"navigating","goal":{"x":1}},"load":5,"none":null}})"));
  const std::vector<Metric> expected = {
      {.category = "power", .name = "battery_percent", .value = 100.0},
      {.category = "power", .name = "charging", .value = false},
      {.category = "power", .name = "cells/0", .value = 3.5},
      {.category = "navigation", .name = "status", .value = std::string("navigating")},
      {.category = "navigation", .name = "goal/x", .value = 1.0},
      {.category = "load", .name = "", .value = 5.0},
  };
  EXPECT_EQ(metrics.metrics, expected);
  EXPECT_FALSE(metrics.errors);
}

TEST(CyberwaveValues, MetricsTellNoErrorsFromNoWordOfErrors) {
  const auto errors = [](const std::string& members) {
    return BodyOf<Metrics>(JudgeOn("metrics", R"({"metrics":{)" + members + "}}")).errors;
  };
  EXPECT_EQ(errors(R"("errors":[])"), std::vector<std::string>());
  EXPECT_EQ(errors(R"("errors":["E1","bumper \u0001"])"),
            (std::vector<std::string>{"E1", "bumper \xEF\xBF\xBD"}));
  EXPECT_FALSE(errors(R"("load":{"errors":["not these"]})"));
}

TEST(CyberwaveValues, EdgeHealth) {
  const EdgeHealth health = BodyOf<EdgeHealth>(JudgeOn(
      "edge_health",
      R"({"edge_id":"edge-7","uptime_seconds":3600.5,"stream_count":1,"healthy_streams":0,)"
      R"("twin_uuid":"11111111-1111-4111-8111-111111111111","camera_config":null,)"
      R"("host_memory_percent":43.5,"host_cpu_percent":-1,"host_disk_percent":77,"cpu_temp_c":61.5,)"
      R"("streams":{"front":{"camera_id":"cam","connection_state":"connected",)"
      R"("ice_connection_state":"new","frames_sent":30,"last_frame_ts":1.5,"fps":29.97,)"
      R"("uptime_seconds":2,"restart_count":1,"is_stale":false,"is_healthy":true}}})"));
  const EdgeStream stream = {.id = "front",
                             .camera_id = "cam",
                             .connection_state = "connected",
                             .ice_connection_state = "new",
                             .frames_sent = 30,
                             .last_frame_us = 1'500'000,
                             .fps = 29.97,
                             .uptime_s = 2,
                             .restart_count = 1,
                             .is_stale = false,
                             .is_healthy = true};
  EXPECT_EQ(health, (EdgeHealth{.edge_id = "edge-7",
                                .uptime_s = 3600.5,
                                .streams = {stream},
                                .stream_count = 1,
                                .healthy_streams = 0,
                                .host_memory_percent = 43.5,
                                .host_cpu_percent = 0,
                                .host_disk_percent = 77,
                                .cpu_temp_c = 61.5}));
}

TEST(CyberwaveValues, EdgeHealthOfOlderEdgesAndOfNone) {
  const auto health = [](const std::string& members) {
    return BodyOf<EdgeHealth>(JudgeOn("edge_health", "{" + members + "}"));
  };
  EXPECT_EQ(health(R"("edge_uuid":"e","uptime":5)"), (EdgeHealth{.edge_id = "e", .uptime_s = 5}));
  EXPECT_EQ(health(""), (EdgeHealth{.edge_id = std::string(test::kTwin)}));
}

TEST(CyberwaveValues, EdgeHealthOfItsTwinInAnyCase) {
  const std::string upper = "AAAAAAAA-AAAA-4AAA-8AAA-AAAAAAAAAAAA";
  EXPECT_EQ(JudgeMessage("cyberwave/twin/aaaaaaaa-aaaa-4aaa-8aaa-aaaaaaaaaaaa/edge_health",
                         R"({"twin_uuid":")" + upper + "\"}", {})
                .rejection(),
            nullptr);
}

TEST(CyberwaveValues, RunsByOurWordsAndTheirs) {
  const auto status = [](const std::string& word) {
    return BodyOf<RunStatus>(
        JudgeOn("navigate/status", R"({"action_id":"a","status":")" + word + "\"}"));
  };
  EXPECT_EQ(status("queued").status, MissionStatus::kReady);
  EXPECT_EQ(status("running").status, MissionStatus::kRunning);
  EXPECT_EQ(status("blocked").status, MissionStatus::kBlocked);
  EXPECT_EQ(status("completed").status, MissionStatus::kComplete);
  EXPECT_EQ(status("failed").status, MissionStatus::kError);
  EXPECT_EQ(status("cancelled").status, MissionStatus::kAborted);
  EXPECT_EQ(status("docking").status, MissionStatus::kUnknown);
  EXPECT_EQ(status("docking").status_text, "docking");
}

TEST(CyberwaveValues, NavigationAndMission) {
  EXPECT_EQ(BodyOf<RunStatus>(JudgeOn("navigate/status", R"({"action_id":"a","status":"running",)"
                                                         R"("progress":45.5,"message":"m"})")),
            (RunStatus{.run_id = "a",
                       .status = MissionStatus::kRunning,
                       .status_text = "running",
                       .message = "m",
                       .progress_percent = 45.5}));
  EXPECT_EQ(BodyOf<RunStatus>(JudgeOn("mission/status",
                                      R"({"mission_execution_uuid":"m","status":"paused",)"
                                      R"("current_step":2,"message":"step"})")),
            (RunStatus{.run_id = "m",
                       .status = MissionStatus::kPaused,
                       .status_text = "paused",
                       .message = "step",
                       .current_step = 2}));
}

TEST(CyberwaveValues, Scopes) {
  const ScopeUpdate environment = BodyOf<ScopeUpdate>(
      JudgeOn("environment/twin_added", R"({"type":"twin_added","data":{"a":[1,true]}})"));
  EXPECT_EQ(environment.scope, ScopeKind::kEnvironment);
  EXPECT_EQ(environment.type, "twin_added");
  EXPECT_EQ(environment.detail, R"({"type":"twin_added","data":{"a":[1,true]}})");
  const ScopeUpdate run = BodyOf<ScopeUpdate>(JudgeOn("workflow-run", R"({"status":"done"})"));
  EXPECT_EQ(run.scope, ScopeKind::kWorkflowRun);
  EXPECT_EQ(run.type, "done");
  EXPECT_EQ(JudgeOn("workflow-run", R"({"status":"done"})").topic.id.ToText(), test::kEnvironment);
}

TEST(CyberwaveValues, HeadsOfCommandsAndNothingElseOfThem) {
  const auto head = [](const std::string& tail, const std::string& payload) {
    const Judgement judgement = JudgeOn(tail, payload);
    EXPECT_EQ(judgement.message_class, MessageClass::kObserved);
    return BodyOf<CommandHead>(judgement);
  };
  EXPECT_EQ(head("command", R"({"command":"arm","type":"t","data":{"key":"secret"}})"),
            (CommandHead{.command = "arm"}));
  EXPECT_EQ(head("command", R"({"type":"start_video"})"), (CommandHead{.command = "start_video"}));
  EXPECT_EQ(head("command", R"({"status":"ok","type":"video_started"})"),
            (CommandHead{.command = "video_started", .status = "ok"}));
  EXPECT_EQ(head("navigate/command", R"({"command":"cancel","action_id":"a"})"),
            (CommandHead{.command = "cancel", .action_id = "a"}));
  EXPECT_EQ(head("command", "{}"), CommandHead());
}

TEST(CyberwaveValues, QuotesNothingOfAPayloadThatItRejectsAsAWhole) {
  for (const std::string& payload :
       {std::string(R"({"key":"secret)"), std::string("\"secret\""),
        std::string("{\"key\":\"secret\xFF\"}"), std::string(R"({"key":"secret\ud83d"})"),
        std::string(R"({"key":"secret","n":NaN})")}) {
    const Judgement judgement = JudgeOn("command", payload);
    ASSERT_NE(judgement.rejection(), nullptr) << payload;
    EXPECT_EQ(judgement.rejection()->detail.find("secret"), std::string::npos) << payload;
    EXPECT_EQ(judgement.message_class, MessageClass::kObserved);
  }
}

TEST(CyberwaveValues, CountsSignallingAndMediaUnseen) {
  const std::string large(2 * kMessageBytesMax, '{');
  for (const std::string tail : {"webrtc-offer", "webrtc-answer", "webrtc-candidate"}) {
    for (const std::string& payload : {std::string(), std::string("\xFF\x00", 2), large}) {
      (void)BodyOf<Signalling>(JudgeOn(tail, payload));
    }
    (void)BodyOf<Signalling>(JudgeUnread(TopicOf(tail), large.size(), {}));
  }
  for (const std::string tail : {"depth", "pointcloud"}) {
    EXPECT_EQ(BodyOf<Media>(JudgeOn(tail, large)).bytes, large.size());
    EXPECT_EQ(BodyOf<Media>(JudgeOn(tail, "")).bytes, 0U);
    EXPECT_EQ(BodyOf<Media>(JudgeUnread(TopicOf(tail), 800'000, {})).bytes, 800'000U);
  }
}

TEST(CyberwaveValues, JudgesWhatWasNotReadByItsSize) {
  const Judgement large = JudgeUnread(TopicOf("event"), kMessageBytesMax + 1, {});
  ASSERT_NE(large.rejection(), nullptr);
  EXPECT_EQ(large.rejection()->reason, model::RejectReason::kPayloadTooLarge);
  EXPECT_EQ(large.topic.id.ToText(), test::kTwin);
  EXPECT_NE(JudgeUnread(TopicOf("event"), 5, {}).rejection(), nullptr);
  (void)BodyOf<Ignored>(JudgeUnread("other", kMessageBytesMax + 1, {}));
}

TEST(CyberwaveValues, PingsAndOtherTopics) {
  const Judgement ping = JudgeOn("ping", R"({"type":"ping"})");
  (void)BodyOf<Ping>(ping);
  EXPECT_EQ(ping.message_class, MessageClass::kPing);
  EXPECT_EQ(ping.topic.name, "me");
  const Judgement other = JudgeOn("map_update", "no matter what");
  (void)BodyOf<Ignored>(other);
  EXPECT_EQ(other.message_class, MessageClass::kOther);
}

TEST(CyberwaveValues, RejectsATopicOfOursWithoutAnIdWhateverItCarries) {
  const Judgement judgement = JudgeMessage("cyberwave/twin/arm/depth", "", {});
  ASSERT_NE(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.rejection()->reason, model::RejectReason::kMalformed);
}

}  // namespace
}  // namespace uplink::cyberwave
