// What the messages of a twin, one after the other, come to.
#include "server/cyberwave/twin_state.h"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::cyberwave {
namespace {

namespace cw = model::cyberwave;
using test::AppliedTwin;

/// A topic's message, what becomes of it, and the same one with something wrong, which must leave
/// no trace.
struct Case {
  std::string name;
  std::string tail;
  std::string good;
  Outcome outcome;
  std::string bad;
};

void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

class TwinTopics : public ::testing::TestWithParam<Case> {};

TEST_P(TwinTopics, TheGoodOneIsTakenAndTheBadOneLeavesNothing) {
  const Case& each = GetParam();
  AppliedTwin twin;
  const Applied applied = twin.Publish(each.tail, each.good);
  EXPECT_EQ(applied.outcome, each.outcome);
  EXPECT_EQ(applied.records.size(), each.outcome == Outcome::kStored ? 1U : 0U);
  AppliedTwin untouched;
  const Applied bad = untouched.Publish(each.tail, each.bad);
  EXPECT_EQ(bad.outcome, Outcome::kRejected);
  EXPECT_TRUE(bad.records.empty());
  EXPECT_EQ(HeldBytes(untouched.real()), HeldBytes(AppliedTwin().real()));
}

INSTANTIATE_TEST_SUITE_P(
    Topics, TwinTopics,
    ::testing::Values(
        Case{"position", "position", R"({"position":{"x":1,"y":2,"z":3}})", Outcome::kApplied,
             R"({"position":{"x":1,"y":2}})"},
        Case{"rotation", "rotation", R"({"rotation":{"z":1}})", Outcome::kApplied,
             R"({"rotation":{"yaw":1}})"},
        Case{"scale", "scale", R"({"scale":{"x":1,"y":2,"z":3}})", Outcome::kApplied,
             R"({"scale":{"x":"1","y":2,"z":3}})"},
        Case{"joints", "joint/update", R"({"_1":0.5})", Outcome::kApplied,
             R"({"joint_name":"","joint_state":{"position":1}})"},
        Case{"joint_states", "joint_states", R"({"joint_states":{"a":1}})", Outcome::kApplied,
             R"({"joint_states":{"a":"1"}})"},
        Case{"metrics", "metrics", R"({"metrics":{"load":{"cpu":1}}})", Outcome::kApplied,
             R"({"metrics":[]})"},
        Case{"errors", "metrics", R"({"metrics":{"errors":["hot"]}})", Outcome::kStored,
             R"({"metrics":{"errors":[1]}})"},
        Case{"edge_health", "edge_health", R"({"edge_id":"e","uptime_seconds":1})",
             Outcome::kApplied, R"({"twin_uuid":"x","edge_id":"e","uptime_seconds":1})"},
        Case{"gps", "gps", R"({"latitude":1,"longitude":2})", Outcome::kApplied,
             R"({"latitude":91,"longitude":200})"},
        Case{"battery", "battery/status", R"({"percentage":50})", Outcome::kApplied,
             R"({"percentage":150})"},
        Case{"motors", "telemetry", R"({"type":"motor_status","a":1})", Outcome::kApplied, "[]"},
        Case{"driver", "telemetry", R"({"type":"driver_info","a":1})", Outcome::kApplied, "{"},
        Case{"report", "telemetry", R"({"telemetry_type":"battery","data":{"level":50}})",
             Outcome::kApplied, R"({"telemetry_type":5})"},
        Case{"robot_state", "event", R"({"event_type":"robot_state","data":{"a":1}})",
             Outcome::kApplied, "frame"},
        Case{"event", "event", R"({"event_type":"bumped","data":{}})", Outcome::kStored,
             R"({"data":{}})"},
        Case{"telemetry", "telemetry", R"({"type":"camera_on"})", Outcome::kStored,
             R"({"data":1})"},
        Case{"driverlog", "driverlog", R"({"message":"m","level":"INFO"})", Outcome::kStored,
             R"({"message":"m"})"},
        Case{"navigate", "navigate/status", R"({"action_id":"a","status":"running"})",
             Outcome::kStored, R"({"action_id":"a"})"},
        Case{"mission", "mission/status", R"({"mission_execution_uuid":"a","status":"running"})",
             Outcome::kStored, R"({"status":"running"})"},
        Case{"command", "command", R"({"command":"stop"})", Outcome::kObserved, "no object"},
        Case{"navigate_command", "navigate/command", R"({"type":"go"})", Outcome::kObserved, "[]"},
        Case{"wanted", "joint/update", R"({"source_type":"tele","_1":1})", Outcome::kObserved,
             "[]"}),
    [](const auto& each) { return each.param.name; });

TEST(TwinStateTest, WhatIsOfNoTwinLeavesItAlone) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("ping", R"({"type":"ping"})"), Outcome::kIgnored);
  EXPECT_EQ(twin.Say("environment/alert", R"({"type":"alert","data":{}})"), Outcome::kStored);
  EXPECT_EQ(twin.Say("workflow-run", R"({"status":"done"})"), Outcome::kStored);
  EXPECT_EQ(twin.Say("workflow-run", "[]"), Outcome::kRejected);
  EXPECT_EQ(twin.Say("unheard-of", "{}"), Outcome::kIgnored);
  EXPECT_EQ(HeldBytes(twin.real()), HeldBytes(AppliedTwin().real()));
}

TEST(TwinStateTest, RoomIsNeededForNoMoreThanAMessageMayMake) {
  AppliedTwin twin;
  const TwinState& state = twin.Of(RobotKind::kReal);
  const auto at_most = [&state](std::string_view tail, std::string_view payload) {
    return state.RecordsAtMost(test::JudgeOn(tail, payload));
  };
  EXPECT_EQ(at_most("joint/update", R"({"_1":1})"), 0U);
  EXPECT_EQ(at_most("telemetry", R"({"type":"motor_status"})"), 0U);
  EXPECT_EQ(at_most("command", R"({"command":"stop"})"), 0U);
  EXPECT_EQ(at_most("event", "broken"), 0U);
  EXPECT_EQ(at_most("event", R"({"event_type":"bumped"})"), 1U);
  EXPECT_EQ(at_most("metrics", R"({"metrics":{"load":1}})"), 0U);
  EXPECT_EQ(at_most("metrics", R"({"metrics":{"errors":["hot","low"]}})"), 2U);
  twin.Say("metrics", R"({"metrics":{"errors":["hot","low"]}})");
  EXPECT_EQ(at_most("metrics", R"({"metrics":{"load":1}})"), 2U) << "what was raised is cleared";
  EXPECT_EQ(at_most("metrics", R"({"metrics":{"errors":["new"]}})"), 3U);
}

TEST(TwinStateTest, ALateValueOfASessionIsSuperseded) {
  AppliedTwin twin;
  const auto position = [&twin](int x, const std::string& session, int time) {
    return twin.Say("position", R"({"position":{"x":)" + std::to_string(x) +
                                    R"(,"y":0,"z":0},"session_id":")" + session +
                                    R"(","timestamp":)" + std::to_string(time) + "}");
  };
  EXPECT_EQ(position(1, "a", 100), Outcome::kApplied);
  EXPECT_EQ(position(2, "a", 99), Outcome::kSuperseded);
  EXPECT_EQ(twin.real().position->value.x_m, 1);
  EXPECT_EQ(position(3, "a", 100), Outcome::kApplied) << "the same time again";
  EXPECT_EQ(position(4, "b", 50), Outcome::kApplied) << "another client, whose clock is behind";
  EXPECT_EQ(position(5, "a", 99), Outcome::kSuperseded) << "still late beside the other client";
  EXPECT_EQ(position(6, "b", 51), Outcome::kApplied);
  EXPECT_EQ(twin.real().position->value.x_m, 6);
  EXPECT_EQ(twin.Say("position", R"({"position":{"x":7,"y":0,"z":0},"session_id":"a"})"),
            Outcome::kApplied)
      << "without a time it counts by its arrival";
  EXPECT_EQ(position(8, "a", 99), Outcome::kSuperseded) << "and changes no time";
  EXPECT_EQ(twin.Say("rotation", R"({"rotation":{"z":1},"session_id":"a","timestamp":99})"),
            Outcome::kApplied)
      << "another topic";
}

TEST(TwinStateTest, EveryLiveTopicKnowsWhatIsLate) {
  const std::vector<std::pair<std::string, std::string>> messages = {
      {"position", R"("position":{"x":1,"y":2,"z":3})"},
      {"rotation", R"("rotation":{"z":1})"},
      {"scale", R"("scale":{"x":1,"y":2,"z":3})"},
      {"joint/update", R"("positions":{"a":1})"},
      {"joint_states", R"("joint_states":{"a":1})"},
      {"metrics", R"("metrics":{"load":1})"},
      {"edge_health", R"("edge_id":"e","uptime_seconds":1)"},
      {"gps", R"("latitude":1,"longitude":2)"},
      {"battery/status", R"("percentage":50)"},
      {"telemetry", R"("type":"motor_status")"},
      {"telemetry", R"("type":"driver_info")"},
      {"telemetry", R"("telemetry_type":"battery","data":{})"},
      {"event", R"("event_type":"robot_state","data":{})"},
  };
  for (const auto& [tail, body] : messages) {
    AppliedTwin twin;
    EXPECT_EQ(twin.Say(tail, "{" + body + R"(,"timestamp":100})"), Outcome::kApplied) << body;
    EXPECT_EQ(twin.Say(tail, "{" + body + R"(,"timestamp":99.9})"), Outcome::kSuperseded) << body;
  }
}

TEST(TwinStateTest, LeaderAndFollowerAreKeptApart) {
  AppliedTwin twin;
  const auto joint = [&twin](const std::string& source, const std::string& body) {
    return twin.Say("joint/update", R"({"source_type":")" + source +
                                        R"(","timestamp":5,"session_id":"s",)" + body + "}");
  };
  EXPECT_EQ(joint("edge_leader", R"("positions":{"a":1})"), Outcome::kApplied);
  EXPECT_EQ(joint("edge_follower", R"("positions":{"a":2},"velocities":{"a":3})"),
            Outcome::kApplied);
  EXPECT_EQ(joint("edge_follower", R"("positions":{"a":4})"), Outcome::kApplied);
  EXPECT_EQ(twin.real().joints.Of(JointGroup::kLeader).at("a").position, 1);
  const HeldJoint& follower = twin.real().joints.Of(JointGroup::kFollower).at("a");
  EXPECT_EQ(follower.position, 4);
  EXPECT_EQ(follower.velocity, 3) << "what a message does not say stays";
  EXPECT_TRUE(twin.real().joints.Of(JointGroup::kEdge).empty());
}

TEST(TwinStateTest, ASourceThatWeDoNotKnowIsTheEdgeUnderItsOwnWord) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("joint/update", R"({"source_type":"robotnik","_1":1})"), Outcome::kApplied);
  EXPECT_EQ(twin.real().joints.Of(JointGroup::kEdge).at("_1").other_source, "robotnik");
  EXPECT_EQ(twin.Say("joint/update", R"({"source_type":"edge","_1":1})"), Outcome::kApplied);
  EXPECT_EQ(twin.real().joints.Of(JointGroup::kEdge).at("_1").other_source, "");
}

TEST(TwinStateTest, TheSimulationIsARobotOfItsOwn) {
  AppliedTwin twin;
  twin.Say("position", R"({"source_type":"edge","position":{"x":1,"y":0,"z":0}})");
  twin.Say("position", R"({"source_type":"sim","position":{"x":2,"y":0,"z":0}})");
  twin.Say("joint/update", R"({"session_id":"me_sim_5d","_1":0.5})");
  twin.Say("joint/update", R"({"source_type":"sim_tele","_1":0.5})");
  EXPECT_EQ(twin.real().position->value.x_m, 1);
  EXPECT_EQ(twin.sim().position->value.x_m, 2);
  EXPECT_EQ(twin.sim().joints.Of(JointGroup::kSim).at("_1").position, 0.5);
  EXPECT_TRUE(twin.real().joints.Of(JointGroup::kSim).empty());
  EXPECT_EQ(twin.sim().observed.setpoints(), 1U);
  EXPECT_EQ(twin.real().observed.setpoints(), 0U);
}

TEST(TwinStateTest, WantedValuesAreCountedAndNeverState) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("joint/update", R"({"positions":{"a":1},"target_positions":{"a":9,"b":9}})"),
            Outcome::kApplied);
  EXPECT_EQ(twin.Say("joint/update", R"({"target_positions":{"a":9}})"), Outcome::kObserved);
  EXPECT_EQ(twin.Say("position", R"({"source_type":"edit","position":{"x":9,"y":9,"z":9}})"),
            Outcome::kObserved);
  EXPECT_EQ(twin.real().joints.Of(JointGroup::kEdge).at("a").position, 1);
  EXPECT_FALSE(twin.real().joints.Of(JointGroup::kEdge).contains("b"));
  EXPECT_FALSE(twin.real().position.has_value());
  EXPECT_EQ(twin.real().observed.setpoints(), 3U);
  EXPECT_EQ(twin.real().observed.observed(TopicKind::kPosition), 1U);
  EXPECT_EQ(twin.real().observed.observed(TopicKind::kJointUpdate), 1U);
}

TEST(TwinStateTest, ACategoryOfMetricsStaysUntilItIsSaidAnew) {
  AppliedTwin twin;
  twin.Say("metrics", R"({"metrics":{"power":{"a":1,"b":2},"load":5}})");
  twin.Say("metrics", R"({"metrics":{"power":{"a":3}}})");
  ASSERT_EQ(twin.real().metrics.size(), 2U);
  const auto& power = twin.real().metrics.Find("power")->value;
  ASSERT_EQ(power.size(), 1U);
  EXPECT_EQ(power[0].value, cw::MetricValue(3.0));
  EXPECT_EQ(twin.real().metrics.Find("load")->value[0].value, cw::MetricValue(5.0));
}

TEST(TwinStateTest, LateMetricsRaiseNothing) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("metrics", R"({"metrics":{"errors":["hot"]},"timestamp":100})"),
            Outcome::kStored);
  EXPECT_EQ(twin.Say("metrics", R"({"metrics":{"errors":["cold"]},"timestamp":99})"),
            Outcome::kSuperseded);
  EXPECT_EQ(twin.Of(RobotKind::kReal).faults().active().size(), 1U);
}

TEST(TwinStateTest, EdgesAndReportsHaveTheirOwnTimes) {
  AppliedTwin twin;
  const auto edge = [&twin](const std::string& id, int time) {
    return twin.Say("edge_health", R"({"uptime_seconds":1,"edge_id":")" + id + R"(","timestamp":)" +
                                       std::to_string(time) + "}");
  };
  EXPECT_EQ(edge("a", 100), Outcome::kApplied);
  EXPECT_EQ(edge("b", 40), Outcome::kApplied) << "two computers without sessions";
  EXPECT_EQ(edge("a", 99), Outcome::kSuperseded);
  EXPECT_EQ(edge("b", 41), Outcome::kApplied);
  EXPECT_EQ(twin.real().edges.size(), 2U);
}

TEST(TwinStateTest, TheLeastRecentlyUpdatedEdgeGoesFirst) {
  AppliedTwin twin;
  for (std::size_t i = 0; i <= kEdgesMax; ++i) {
    twin.Say("edge_health", R"({"uptime_seconds":1,"edge_id":"e)" + std::to_string(i) + R"("})");
    twin.Say("edge_health", R"({"uptime_seconds":1,"edge_id":"e0"})");
  }
  EXPECT_EQ(twin.real().edges.size(), kEdgesMax);
  EXPECT_NE(twin.real().edges.Find("e0"), nullptr);
  EXPECT_EQ(twin.real().edges.Find("e1"), nullptr);
  EXPECT_EQ(twin.Of(RobotKind::kReal).keys_evicted(), 1U);
}

TEST(TwinStateTest, MediaAreCountedWithTheirBytes) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("depth", std::string(100'000, 'x')), Outcome::kObserved);
  EXPECT_EQ(twin.Say("depth", "{}"), Outcome::kObserved);
  EXPECT_EQ(twin.Say("pointcloud", "123"), Outcome::kObserved);
  EXPECT_EQ(twin.real().observed.media(TopicKind::kDepth).messages, 2U);
  EXPECT_EQ(twin.real().observed.media(TopicKind::kDepth).bytes, 100'002U);
  EXPECT_EQ(twin.real().observed.media(TopicKind::kPointcloud).bytes, 3U);
}

TEST(TwinStateTest, OfTheLastCommandTheHeadIsShown) {
  AppliedTwin twin;
  twin.Say("command", R"({"command":"stop","data":{"token":"s3cret"},"source_type":"tele"})");
  twin.Say("command", R"({"type":"stopped","status":"ok"})");
  twin.Say("navigate/command", R"({"status":"busy"})");
  const auto& last = twin.real().observed.last_command();
  ASSERT_TRUE(last.has_value());
  EXPECT_EQ(last->head.command, "stop");
  EXPECT_EQ(last->head.status, "ok") << "an answer, on the topic of its command";
  EXPECT_EQ(last->source.text, "tele");
  EXPECT_EQ(twin.real().observed.observed(TopicKind::kCommand), 2U);
  twin.Say("navigate/command", R"({"command":"go","action_id":"a"})");
  EXPECT_EQ(twin.real().observed.last_command()->head.command, "go");
  EXPECT_EQ(twin.real().observed.last_command()->head.status, "");
}

TEST(TwinStateTest, SignallingIsANumber) {
  AppliedTwin twin;
  const std::size_t before = HeldBytes(twin.real());
  EXPECT_EQ(twin.Say("webrtc-offer", R"({"sdp":"v=0 a=ice-pwd:x"})"), Outcome::kObserved);
  EXPECT_EQ(twin.Say("webrtc-candidate", "anything"), Outcome::kObserved);
  EXPECT_EQ(twin.real().observed.observed(TopicKind::kWebrtcOffer), 1U);
  EXPECT_EQ(twin.real().observed.observed(TopicKind::kWebrtcCandidate), 1U);
  EXPECT_EQ(HeldBytes(twin.real()), before);
}

TEST(TwinStateTest, AMarkIsStoredAndChangesItsSession) {
  AppliedTwin twin;
  EXPECT_EQ(twin.Say("telemetry", R"({"type":"connected","session_id":"viewer"})"),
            Outcome::kStored);
  EXPECT_EQ(twin.Say("telemetry", R"({"type":"connected","session_id":"me_sim_5d"})"),
            Outcome::kStored);
  ASSERT_EQ(twin.real().sessions.sessions().size(), 1U);
  EXPECT_EQ(twin.real().sessions.sessions().front().first, "viewer");
  ASSERT_EQ(twin.sim().sessions.sessions().size(), 1U);
  EXPECT_EQ(twin.sim().sessions.sessions().front().first, "me_sim_5d");
}

TEST(TwinStateTest, ASessionThatPublishesIsNotTheOneThatGoes) {
  AppliedTwin twin;
  const auto mark = [&twin](const std::string& session) {
    twin.Say("telemetry", R"({"type":"connected","session_id":")" + session + R"("})");
  };
  mark("driver");
  for (std::size_t i = 0; i < kMarkedSessionsMax; ++i) {
    twin.Say("joint/update", R"({"_1":1,"session_id":"driver"})");
    mark("viewer" + std::to_string(i));
  }
  const auto& sessions = twin.real().sessions.sessions();
  EXPECT_EQ(sessions.size(), kMarkedSessionsMax);
  const auto is_driver = [](const auto& each) { return each.first == "driver"; };
  EXPECT_TRUE(std::any_of(sessions.begin(), sessions.end(), is_driver));
}

TEST(TwinStateTest, TheBridgesFrameIsAnEventOfItsContent) {
  const std::string head(16, '\0');
  const std::string meta = R"({"content_type":"application/json"})";
  const std::string about = head + meta;
  std::string frame;
  for (std::size_t i = 0; i < 4; ++i) {
    frame.push_back(static_cast<char>(about.size() >> (8 * i) & 0xFF));
  }
  AppliedTwin twin;
  const Applied applied =
      twin.Publish("event", frame + about + R"({"event_type":"bumped","data":{"at":"door"}})");
  ASSERT_EQ(applied.outcome, Outcome::kStored);
  const auto& record = std::get<model::Record>(applied.records.at(0));
  const auto& event = std::get<model::EventTelemetry>(record.body());
  EXPECT_EQ(model::EventKindText(event.kind), "cyberwave/bumped");
}

}  // namespace
}  // namespace uplink::cyberwave
