// Which robot a message is of, and which one it proves to be there.
#include "server/cyberwave/whose.h"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

std::optional<RobotKind> Sign(std::string_view tail, std::string_view payload) {
  return SignOfLifeOf(test::JudgeOn(tail, payload));
}

TEST(WhoseTest, ARobotHasTheRuriOfItsTwinAndKind) {
  const std::string twin(test::kTwin);
  EXPECT_EQ(RuriOf(test::JudgeOn("position", R"({"position":{"x":1,"y":2,"z":3}})")),
            "rcan://local.rcan/cyberwave/twin/" + twin);
  EXPECT_EQ(RuriOf(test::JudgeOn("joint/update", R"({"source_type":"sim","_1":1})")),
            "rcan://local.rcan/cyberwave/sim/" + twin);
  EXPECT_EQ(
      RuriOf(JudgeMessage("site/a/cyberwave/joint/" + twin + "/update",
                          R"({"source_type":"sim_tele","_1":1})", {.prefixes = {"", "site/a/"}})),
      "rcan://local.rcan/cyberwave/sim.site%2Fa%2F/" + twin);
}

TEST(WhoseTest, WhatIsOfNoRobotStandsInItsPrefixesName) {
  const JudgeTerms terms = {.prefixes = {"", "site/a/"}, .prismatic_joints = {}};
  const auto judge = [&terms](const std::string& topic) {
    return JudgeMessage(topic, "{}", terms);
  };
  const std::string id(test::kEnvironment);
  for (const std::string& tail : std::vector<std::string>{
           "environment/" + id + "/added", "workflow-run/" + id + "/status", "ping/me/request",
           "twin/no-uuid/position", "twin/no-uuid/webrtc-offer",
           "environment/" + id + "/" + std::string(300, 'x')}) {
    for (const std::string prefix : {"", "site/a/"}) {
      const Judgement judgement = judge(std::string(prefix).append("cyberwave/").append(tail));
      EXPECT_EQ(RobotOf(judgement), std::nullopt) << tail;
      EXPECT_EQ(SignOfLifeOf(judgement), std::nullopt) << tail;
      EXPECT_EQ(RuriOf(judgement), "cyberwave:" + prefix) << tail;
    }
  }
}

TEST(WhoseTest, StateIsASignOfLifeOfItsRobot) {
  EXPECT_EQ(Sign("joint/update", R"({"_1":1})"), RobotKind::kReal);
  EXPECT_EQ(Sign("joint/update", R"({"source_type":"edge_leader","_1":1})"), RobotKind::kReal);
  EXPECT_EQ(Sign("joint/update", R"({"source_type":"sim","_1":1})"), RobotKind::kSimulated);
  EXPECT_EQ(Sign("joint/update", R"({"session_id":"me_sim_5d","_1":1})"), RobotKind::kSimulated);
  EXPECT_EQ(Sign("event", R"({"event_type":"bumped"})"), RobotKind::kReal);
  EXPECT_EQ(Sign("driverlog", R"({"message":"m","level":"info"})"), RobotKind::kReal);
  EXPECT_EQ(Sign("position", R"({"position":{"x":1}})"), RobotKind::kReal)
      << "rejected, but it is there";
}

TEST(WhoseTest, WhoWatchesOrCommandsASilentTwinProvesNothing) {
  for (const std::string mark :
       {"connected", "telemetry_start", "telemetry_end", "disconnected", "initial_observation"}) {
    EXPECT_EQ(Sign("telemetry", R"({"type":")" + mark + R"(","session_id":"viewer_live_5d"})"),
              std::nullopt)
        << mark;
    EXPECT_EQ(Sign("telemetry", R"({"type":")" + mark + R"(","session_id":"me_sim_5d"})"),
              std::nullopt)
        << mark << " of a simulation";
  }
  EXPECT_EQ(Sign("joint/update", R"({"source_type":"tele","_1":1})"), std::nullopt);
  EXPECT_EQ(Sign("joint/update", R"({"source_type":"sim_tele","_1":1})"), std::nullopt);
  EXPECT_EQ(Sign("scale", R"({"source_type":"edit","scale":{"x":1,"y":1,"z":1}})"), std::nullopt);
  EXPECT_EQ(Sign("command", R"({"command":"stop"})"), std::nullopt);
  EXPECT_EQ(Sign("webrtc-offer", "{}"), std::nullopt);
  EXPECT_EQ(Sign("depth", "{}"), std::nullopt);
  EXPECT_EQ(Sign("environment/alert", R"({"type":"alert","data":{}})"), std::nullopt);
  EXPECT_EQ(Sign("position", "broken"), std::nullopt);
}

}  // namespace
}  // namespace uplink::cyberwave
