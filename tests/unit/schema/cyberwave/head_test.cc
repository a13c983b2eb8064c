// Who speaks, when, and whether it is a sign of life.
#include "schema/cyberwave/head.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Commanded;
using model::cyberwave::SourceType;
using test::JudgeOn;

std::string Position(const std::string& members) {
  return R"({"position":{"x":1,"y":2,"z":3})" + (members.empty() ? "" : "," + members) + "}";
}
Judgement JudgeWith(const std::string& members) { return JudgeOn("position", Position(members)); }

TEST(CyberwaveHead, TakesStateFromTheseSources) {
  for (const std::string word : {"edge", "edge_leader", "edge_follower", "sim"}) {
    const Judgement judgement = JudgeWith(R"("source_type":")" + word + "\"");
    EXPECT_EQ(judgement.message_class, MessageClass::kLive) << word;
    EXPECT_EQ(ToText(judgement.head.source.type), word);
    EXPECT_EQ(judgement.head.source.text, word);
    EXPECT_TRUE(judgement.sign_of_life);
  }
}

TEST(CyberwaveHead, TakesCommandsFromThese) {
  for (const std::string word : {"tele", "sim_tele", "edit", "preview"}) {
    for (const std::string tail : {"position", "rotation", "joint/update", "joint_states"}) {
      const Judgement judgement =
          JudgeOn(tail, R"({"position":{"x":1,"y":2,"z":3},"rotation":{"w":1},"source_type":")" +
                            word + "\"}");
      EXPECT_EQ(judgement.message_class, MessageClass::kObserved) << tail << word;
      EXPECT_EQ(test::BodyOf<Commanded>(judgement).setpoints, 0U);
      EXPECT_FALSE(judgement.sign_of_life);
    }
  }
}

TEST(CyberwaveHead, KeepsOtherTopicsOfTheirClassButNoSignOfLife) {
  for (const std::string word : {"tele", "sim_tele", "edit", "preview"}) {
    const std::string head = R"({"source_type":")" + word + "\",";
    const Judgement scale = JudgeOn("scale", head + R"("scale":{"x":1,"y":1,"z":1}})");
    EXPECT_EQ(scale.message_class, MessageClass::kLive);
    EXPECT_FALSE(scale.sign_of_life);
    const Judgement run = JudgeOn("navigate/status", head + R"("action_id":"a","status":"x"})");
    EXPECT_EQ(run.message_class, MessageClass::kDurable);
    EXPECT_EQ(run.rejection(), nullptr);
    EXPECT_FALSE(run.sign_of_life);
  }
}

TEST(CyberwaveHead, TakesAnUnknownSourceAsTheEdgeAndKeepsItsWord) {
  const Judgement judgement = JudgeWith(R"("source_type":"live")");
  EXPECT_EQ(judgement.head.source.type, SourceType::kUnknown);
  EXPECT_EQ(judgement.head.source.text, "live");
  EXPECT_EQ(judgement.message_class, MessageClass::kLive);
  EXPECT_TRUE(judgement.sign_of_life);
  EXPECT_EQ(JudgeWith(R"("source_type":"EDGE")").head.source.type, SourceType::kUnknown);
}

TEST(CyberwaveHead, GoesByTheSessionWhereNoSourceIsSaid) {
  for (const std::string absent : {"", R"("source_type":null,)", R"("source_type":"",)"}) {
    EXPECT_EQ(JudgeWith(absent + R"("session_id":"nav_sim_5d5d")").head.source.type,
              SourceType::kSim);
    EXPECT_EQ(JudgeWith(absent + R"("session_id":"nav_live_5d5d")").head.source.type,
              SourceType::kEdge);
    EXPECT_EQ(JudgeWith(absent + R"("session_id":null)").head.source.type, SourceType::kEdge);
    EXPECT_EQ(JudgeWith(absent + R"("session_id":"nav_sim_5d5d")").head.source.text, "");
  }
  EXPECT_EQ(JudgeWith(R"("source_type":"edge","session_id":"nav_sim_5d5d")").head.source.type,
            SourceType::kEdge);
}

TEST(CyberwaveHead, TellsSessionsOfASimulation) {
  for (const char* simulated :
       {"python-sdk_sim_5d5d5d5d5d5d4d5d8d5d5d5d5d5d5d5d", "sdk_sim_5d5d5d5d5d5d", "a_sim_0",
        "a_sim_AF", "a_sim_5d_front", "a_live_5d_sim_5d", "my_sim_ab_sim_5d"}) {
    EXPECT_TRUE(IsSimulatedSession(simulated)) << simulated;
  }
  for (const char* real : {"", "sim", "_sim_5d", "a_sim_", "a_sim_xyz", "a_sim_5dg", "a_sim_5d-b",
                           "a_SIM_5d", "a_live_5d", "my_sim_ab_live_5d", "group-1", "a_sim__5d"}) {
    EXPECT_FALSE(IsSimulatedSession(real)) << real;
  }
}

TEST(CyberwaveHead, ReadsTimesAsMicroseconds) {
  EXPECT_EQ(JudgeWith(R"("timestamp":1795362440.281389)").head.timestamp_us, 1'795'362'440'281'389);
  EXPECT_EQ(JudgeWith(R"("ts":1795362440)").head.timestamp_us, 1'795'362'440'000'000);
  EXPECT_EQ(JudgeWith(R"("ts":7,"timestamp":5)").head.timestamp_us, 5'000'000);
  EXPECT_EQ(JudgeWith(R"("ts":7,"timestamp":null)").head.timestamp_us, 7'000'000);
  EXPECT_EQ(JudgeWith(R"("timestamp":4102444799.999)").head.timestamp_us, 4'102'444'799'999'000);
  const Judgement none = JudgeWith("");
  EXPECT_EQ(none.head.timestamp_us, 0);
  EXPECT_EQ(none.times_unknown, 0U);
}

TEST(CyberwaveHead, TakesAnAbsurdTimeAsUnknownAndCountsIt) {
  for (const std::string time :
       {"-1", "4102444800", "1795362440281", "1e400", "\"2026-11-25T06:00:00Z\"", "true", "[]"}) {
    const Judgement judgement = JudgeWith("\"timestamp\":" + time);
    EXPECT_EQ(judgement.rejection(), nullptr) << time;
    EXPECT_TRUE(judgement.dropped.empty()) << time;
    EXPECT_EQ(judgement.head.timestamp_us, 0) << time;
    EXPECT_EQ(judgement.times_unknown, 1U) << time;
  }
}

TEST(CyberwaveHead, IsReadOfARejectedMessageToo) {
  const Judgement judgement =
      JudgeOn("navigate/status", R"({"source_type":"sim","session_id":"s","timestamp":5})");
  ASSERT_NE(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.head.source.type, SourceType::kSim);
  EXPECT_EQ(judgement.head.session_id, "s");
  EXPECT_EQ(judgement.head.timestamp_us, 5'000'000);
  EXPECT_EQ(judgement.topic.id.ToText(), test::kTwin);
}

TEST(CyberwaveSignOfLife, IsWhatDecodesOfATwinWithState) {
  EXPECT_TRUE(JudgeOn("gps", "{}").sign_of_life);
  EXPECT_TRUE(JudgeOn("gps", R"({"altitude":"x"})").sign_of_life);
  EXPECT_TRUE(JudgeOn("event", R"({"event_type":"e"})").sign_of_life);
  EXPECT_TRUE(JudgeOn("event", "{}").sign_of_life);
  EXPECT_TRUE(JudgeOn("telemetry", R"({"type":"camera_stored"})").sign_of_life);
  EXPECT_TRUE(JudgeOn("metrics", R"({"metrics":{}})").sign_of_life);
}

TEST(CyberwaveSignOfLife, IsNothingElse) {
  EXPECT_FALSE(JudgeOn("gps", "{").sign_of_life);
  EXPECT_FALSE(JudgeOn("gps", "[]").sign_of_life);
  EXPECT_FALSE(JudgeOn("edge_health", R"({"twin_uuid":"x"})").sign_of_life);
  EXPECT_FALSE(JudgeOn("command", R"({"command":"stop"})").sign_of_life);
  EXPECT_FALSE(JudgeOn("webrtc-offer", "{}").sign_of_life);
  EXPECT_FALSE(JudgeOn("depth", "{}").sign_of_life);
  EXPECT_FALSE(JudgeOn("environment/t", R"({"type":"t","data":{}})").sign_of_life);
  EXPECT_FALSE(JudgeOn("workflow-run", R"({"status":"ok"})").sign_of_life);
  EXPECT_FALSE(JudgeOn("ping", R"({"type":"ping"})").sign_of_life);
  for (const std::string mark :
       {"connected", "telemetry_start", "telemetry_end", "disconnected", "initial_observation"}) {
    EXPECT_FALSE(JudgeOn("telemetry", R"({"type":")" + mark + "\"}").sign_of_life) << mark;
    EXPECT_FALSE(
        JudgeOn("telemetry", R"({"source_type":"edge","type":")" + mark + "\"}").sign_of_life);
  }
}

}  // namespace
}  // namespace uplink::cyberwave
