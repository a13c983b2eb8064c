// What a live message goes without, and what rejects it because nothing of it is left: each rule by
// its name, with a payload that keeps it and one that breaks it.
#include <string>

#include <gtest/gtest.h>

#include "schema/limits.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::RejectReason;
using test::JudgeOn;
using test::Long;
using test::NameOf;
using test::Rule;

class Dropping : public ::testing::TestWithParam<Rule> {};

TEST_P(Dropping, TheBadFieldIsDroppedAndTheRestKept) {
  const Rule& rule = GetParam();
  const Judgement good = JudgeOn(rule.tail, rule.good);
  EXPECT_EQ(good.rejection(), nullptr) << good.rejection()->field << good.rejection()->detail;
  EXPECT_TRUE(good.dropped.empty()) << good.dropped.front().field << good.dropped.front().detail;
  const Judgement bad = JudgeOn(rule.tail, rule.bad);
  ASSERT_EQ(bad.rejection(), nullptr) << bad.rejection()->field << bad.rejection()->detail;
  ASSERT_EQ(bad.dropped.size(), 1U);
  EXPECT_EQ(bad.dropped.front().reason, rule.reason) << bad.dropped.front().detail;
  EXPECT_EQ(bad.dropped.front().field, rule.field);
  EXPECT_FALSE(bad.dropped.front().detail.empty());
}

/// One good field, so that something is left.
std::string Gps(const std::string& members) { return R"({"signal_level":4,)" + members + "}"; }
std::string Battery(const std::string& members) { return R"({"charging":true,)" + members + "}"; }
std::string Metrics(const std::string& members) {
  return R"({"metrics":{"load":1,)" + members + "}}";
}
std::string Health(const std::string& members) { return R"({"stream_count":0,)" + members + "}"; }
std::string Stream(const std::string& members) {
  return R"({"streams":{"front":{)" + members + "}}}";
}
std::string Position(const std::string& members) {
  return R"({"position":{"x":1,"y":2,"z":3},)" + members + "}";
}

INSTANTIATE_TEST_SUITE_P(
    Head, Dropping,
    ::testing::Values(
        Rule{"session length", "position", Position("\"session_id\":" + Long(128)),
             Position("\"session_id\":" + Long(129)), RejectReason::kTextTooLong, "session_id"},
        Rule{"session a text", "position", Position(R"("session_id":null)"),
             Position(R"("session_id":7)"), RejectReason::kTypeMismatch, "session_id"},
        Rule{"source_type a text", "position", Position(R"("source_type":null)"),
             Position(R"("source_type":7)"), RejectReason::kTypeMismatch, "source_type"},
        Rule{"source_type length", "position", Position("\"source_type\":" + Long(256)),
             Position("\"source_type\":" + Long(257)), RejectReason::kTextTooLong, "source_type"},
        Rule{"source_type without NUL", "position", Position(R"("source_type":"x")"),
             Position(R"("source_type":"x\u0000")"), RejectReason::kTextNotUtf8, "source_type"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    GpsAndBattery, Dropping,
    ::testing::Values(
        Rule{"latitude", "gps", Gps(R"("latitude":90,"longitude":1)"),
             Gps(R"("latitude":90.1,"longitude":1)"), RejectReason::kOutOfRange, "latitude"},
        Rule{"latitude below", "gps", Gps(R"("latitude":-90,"longitude":1)"),
             Gps(R"("latitude":-90.1,"longitude":1)"), RejectReason::kOutOfRange, "latitude"},
        Rule{"longitude", "gps", Gps(R"("latitude":9,"longitude":180)"),
             Gps(R"("latitude":9,"longitude":180.1)"), RejectReason::kOutOfRange, "longitude"},
        Rule{"longitude below", "gps", Gps(R"("latitude":9,"longitude":-180)"),
             Gps(R"("latitude":9,"longitude":-180.1)"), RejectReason::kOutOfRange, "longitude"},
        Rule{"longitude a number", "gps", Gps(R"("latitude":9,"longitude":1)"),
             Gps(R"("latitude":9,"longitude":"1")"), RejectReason::kTypeMismatch, "longitude"},
        Rule{"latitude with longitude", "gps", Gps(R"("latitude":null,"longitude":null)"),
             Gps(R"("latitude":null,"longitude":1)"), RejectReason::kMissingField, "latitude"},
        Rule{"longitude with latitude", "gps", Gps(R"("altitude":1)"), Gps(R"("latitude":1)"),
             RejectReason::kMissingField, "longitude"},
        Rule{"altitude", "gps", Gps(R"("altitude":100000)"), Gps(R"("altitude":100001)"),
             RejectReason::kOutOfRange, "altitude"},
        Rule{"altitude within a double", "gps", Gps(R"("altitude":0)"), Gps(R"("altitude":1e400)"),
             RejectReason::kNotFinite, "altitude"},
        Rule{"heading a number", "gps", Gps(R"("compass_heading":720)"),
             Gps(R"("compass_heading":true)"), RejectReason::kTypeMismatch, "compass_heading"},
        Rule{"accuracy", "gps", Gps(R"("horizontal_accuracy":0)"),
             Gps(R"("horizontal_accuracy":-1)"), RejectReason::kOutOfRange, "horizontal_accuracy"},
        Rule{"vertical accuracy", "gps", Gps(R"("vertical_accuracy":0)"),
             Gps(R"("vertical_accuracy":-1)"), RejectReason::kOutOfRange, "vertical_accuracy"},
        Rule{"satellites whole", "gps", Gps(R"("satellite_count":12)"),
             Gps(R"("satellite_count":1.5)"), RejectReason::kTypeMismatch, "satellite_count"},
        Rule{"fix length", "gps", Gps("\"fix_type\":" + Long(256)),
             Gps("\"fix_type\":" + Long(257)), RejectReason::kTextTooLong, "fix_type"},
        Rule{"percentage", "battery/status", Battery(R"("percentage":105)"),
             Battery(R"("percentage":105.5)"), RejectReason::kOutOfRange, "percentage"},
        Rule{"percentage below", "battery/status", Battery(R"("percentage":-5)"),
             Battery(R"("percentage":-6)"), RejectReason::kOutOfRange, "percentage"},
        Rule{"voltage a number", "battery/status", Battery(R"("voltage":48.5)"),
             Battery(R"("voltage":"48")"), RejectReason::kTypeMismatch, "voltage"},
        Rule{"charging a boolean", "battery/status", R"({"percentage":5,"charging":false})",
             R"({"percentage":5,"charging":0})", RejectReason::kTypeMismatch, "charging"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    MetricsAndHealth, Dropping,
    ::testing::Values(
        Rule{"metric percent", "metrics", Metrics(R"("power":{"battery_percent":105})"),
             Metrics(R"("power":{"battery_percent":106})"), RejectReason::kOutOfRange,
             "metrics.power.battery_percent"},
        Rule{"metric known a number", "metrics", Metrics(R"("power":{"voltage":48})"),
             Metrics(R"("power":{"voltage":"48"})"), RejectReason::kTypeMismatch,
             "metrics.power.voltage"},
        Rule{"metric known no boolean", "metrics", Metrics(R"("navigation":{"eta_seconds":4})"),
             Metrics(R"("navigation":{"eta_seconds":true})"), RejectReason::kTypeMismatch,
             "metrics.navigation.eta_seconds"},
        Rule{"metric within a double", "metrics", Metrics(R"("a":[1,2])"),
             Metrics(R"("a":[1,1e400])"), RejectReason::kNotFinite, "metrics.a[1]"},
        Rule{"metric name length", "metrics", Metrics("\"a\":{" + Long(254) + ":1}"),
             Metrics("\"a\":{" + Long(255) + ":1}"), RejectReason::kTextTooLong,
             "metrics.a." + std::string(64, 'a')},
        Rule{"metric text length", "metrics", Metrics("\"a\":" + Long(8192)),
             Metrics("\"a\":" + Long(8193)), RejectReason::kTextTooLong, "metrics.a"},
        Rule{"metric text without NUL", "metrics", Metrics(R"("a":"b")"),
             Metrics(R"("a":"\u0000")"), RejectReason::kTextNotUtf8, "metrics.a"},
        Rule{"uptime", "edge_health", Health(R"("uptime_seconds":0)"),
             Health(R"("uptime_seconds":-1)"), RejectReason::kOutOfRange, "uptime_seconds"},
        Rule{"older uptime", "edge_health", Health(R"("uptime":5)"), Health(R"("uptime":"5")"),
             RejectReason::kTypeMismatch, "uptime"},
        Rule{"memory", "edge_health", Health(R"("host_memory_percent":100)"),
             Health(R"("host_memory_percent":200)"), RejectReason::kOutOfRange,
             "host_memory_percent"},
        Rule{"cpu", "edge_health", Health(R"("host_cpu_percent":100)"),
             Health(R"("host_cpu_percent":-50)"), RejectReason::kOutOfRange, "host_cpu_percent"},
        Rule{"disk", "edge_health", Health(R"("host_disk_percent":100)"),
             Health(R"("host_disk_percent":1e400)"), RejectReason::kNotFinite, "host_disk_percent"},
        Rule{"temperature", "edge_health", Health(R"("cpu_temp_c":1000)"),
             Health(R"("cpu_temp_c":1001)"), RejectReason::kOutOfRange, "cpu_temp_c"},
        Rule{"streams an object", "edge_health", Health(R"("streams":{})"),
             Health(R"("streams":[])"), RejectReason::kTypeMismatch, "streams"},
        Rule{"stream an object", "edge_health", Health(R"("streams":{"a":null})"),
             Health(R"("streams":{"a":1})"), RejectReason::kTypeMismatch, "streams.a"},
        Rule{"stream with an id", "edge_health", Health(R"("streams":{"a":{}})"),
             Health(R"("streams":{"":{}})"), RejectReason::kMissingField, "streams"},
        Rule{"stream id length", "edge_health", Health("\"streams\":{" + Long(128) + ":{}}"),
             Health("\"streams\":{" + Long(129) + ":{}}"), RejectReason::kTextTooLong,
             "streams." + std::string(64, 'a')},
        Rule{"stream fps", "edge_health", Stream(R"("fps":30)"), Stream(R"("fps":"30")"),
             RejectReason::kTypeMismatch, "streams.front.fps"},
        Rule{"stream state length", "edge_health", Stream("\"connection_state\":" + Long(256)),
             Stream("\"connection_state\":" + Long(257)), RejectReason::kTextTooLong,
             "streams.front.connection_state"},
        Rule{"stream frames whole", "edge_health", Stream(R"("frames_sent":12345)"),
             Stream(R"("frames_sent":-1)"), RejectReason::kOutOfRange,
             "streams.front.frames_sent"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Reports, Dropping,
    ::testing::Values(
        Rule{"battery level", "telemetry", R"({"telemetry_type":"battery","data":{"level":105}})",
             R"({"telemetry_type":"battery","data":{"level":200}})", RejectReason::kOutOfRange,
             "data.level"},
        Rule{"battery charging", "telemetry",
             R"({"telemetry_type":"battery","data":{"charging":true}})",
             R"({"telemetry_type":"battery","data":{"charging":"yes"}})",
             RejectReason::kTypeMismatch, "data.charging"},
        Rule{"telemetry data an object", "telemetry", R"({"telemetry_type":"x","data":null})",
             R"({"telemetry_type":"x","data":1})", RejectReason::kTypeMismatch, "data"},
        Rule{"motor numbers", "telemetry", R"({"type":"motor_status","m":{"t":1}})",
             R"({"type":"motor_status","m":{"t":1e400}})", RejectReason::kNotFinite, "m.t"},
        Rule{"driver texts", "telemetry", R"({"type":"driver_info","m":["t"]})",
             R"({"type":"driver_info","m":["\u0000"]})", RejectReason::kTextNotUtf8, "m[0]"},
        Rule{"robot state numbers", "event", R"({"event_type":"robot_state","data":{"v":null}})",
             R"({"event_type":"robot_state","data":{"v":1e400}})", RejectReason::kNotFinite,
             "data.v"},
        Rule{"command length", "command", R"({"command":)" + Long(256) + "}",
             R"({"command":)" + Long(257) + "}", RejectReason::kTextTooLong, "command"}),
    NameOf);

/// In which the bad message has nothing else.
class Emptying : public ::testing::TestWithParam<Rule> {};

TEST_P(Emptying, TheMessageIsRejectedWithTheReasonOfItsOnlyPart) {
  const Rule& rule = GetParam();
  const Judgement good = JudgeOn(rule.tail, rule.good);
  EXPECT_EQ(good.rejection(), nullptr) << good.rejection()->field << good.rejection()->detail;
  const Judgement bad = JudgeOn(rule.tail, rule.bad);
  ASSERT_NE(bad.rejection(), nullptr);
  EXPECT_EQ(bad.rejection()->reason, rule.reason) << bad.rejection()->detail;
  EXPECT_EQ(bad.rejection()->field, rule.field);
  EXPECT_TRUE(bad.sign_of_life);
}

INSTANTIATE_TEST_SUITE_P(
    Poses, Emptying,
    ::testing::Values(
        Rule{"position", "position", R"({"position":{"x":1,"y":2,"z":3}})", "{}",
             RejectReason::kMissingField, "position"},
        Rule{"position an object", "position", R"({"position":{"x":1,"y":2,"z":3}})",
             R"({"position":[1,2,3]})", RejectReason::kTypeMismatch, "position"},
        Rule{"position x", "position", R"({"position":{"x":1,"y":2,"z":3}})",
             R"({"position":{"x":null,"y":2,"z":3}})", RejectReason::kMissingField, "position.x"},
        Rule{"position y", "position", R"({"position":{"x":1,"y":1e9,"z":3}})",
             R"({"position":{"x":1,"y":1000000001,"z":3}})", RejectReason::kOutOfRange,
             "position.y"},
        Rule{"position z below", "position", R"({"position":{"x":1,"y":2,"z":-1e9}})",
             R"({"position":{"x":1,"y":2,"z":-1e10}})", RejectReason::kOutOfRange, "position.z"},
        Rule{"position text", "position", R"({"position":{"x":1,"y":2,"z":3}})",
             R"({"position":{"x":1,"y":2,"z":"3"}})", RejectReason::kTypeMismatch, "position.z"},
        Rule{"position within a double", "position", R"({"position":{"x":1,"y":2,"z":3}})",
             R"({"position":{"x":1e400,"y":2,"z":3}})", RejectReason::kNotFinite, "position.x"},
        Rule{"rotation", "rotation", R"({"rotation":{"w":1}})", R"({"orientation":{"w":1}})",
             RejectReason::kMissingField, "rotation"},
        Rule{"rotation with a part", "rotation", R"({"rotation":{"z":1}})",
             R"({"rotation":{"yaw":90}})", RejectReason::kMissingField, "rotation"},
        Rule{"rotation with a part there", "rotation", R"({"rotation":{"z":1,"w":null}})",
             R"({"rotation":{"z":null}})", RejectReason::kMissingField, "rotation"},
        Rule{"rotation text", "rotation", R"({"rotation":{"w":1,"x":0}})",
             R"({"rotation":{"w":1,"x":"0"}})", RejectReason::kTypeMismatch, "rotation.x"},
        Rule{"scale", "scale", R"({"scale":{"x":1,"y":1,"z":1}})", R"({"scale":{"x":1,"y":1}})",
             RejectReason::kMissingField, "scale.z"},
        Rule{"scale boolean", "scale", R"({"scale":{"x":1,"y":1,"z":1}})",
             R"({"scale":{"x":1,"y":true,"z":1}})", RejectReason::kTypeMismatch, "scale.y"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Others, Emptying,
    ::testing::Values(
        Rule{"gps", "gps", "{}", R"({"altitude":"high"})", RejectReason::kTypeMismatch, "altitude"},
        Rule{"battery", "battery/status", "{}", R"({"percentage":780})", RejectReason::kOutOfRange,
             "percentage"},
        Rule{"metrics", "metrics", R"({"metrics":{}})",
             R"({"metrics":{"power":{"battery_percent":780}}})", RejectReason::kOutOfRange,
             "metrics.power.battery_percent"},
        Rule{"health", "edge_health", R"({"edge_id":"e"})", R"({"edge_id":"e","stream_count":-1})",
             RejectReason::kOutOfRange, "stream_count"},
        Rule{"joint map", "joint/update", R"({"positions":{}})", R"({"positions":{"a":"1"}})",
             RejectReason::kTypeMismatch, "positions.a"},
        Rule{"joint", "joint/update", R"({"joint_name":"a","joint_state":{}})",
             R"({"joint_name":"a","joint_state":{"position":"1"}})", RejectReason::kTypeMismatch,
             "joint_state.position"},
        Rule{"joint states", "joint_states", "{}", R"({"joint_states":[]})",
             RejectReason::kTypeMismatch, "joint_states"}),
    NameOf);

TEST(CyberwaveDropping, TellsTheFirstFieldsAndCountsTheRest) {
  const Judgement judgement = JudgeOn(
      "joint/update", R"({"positions":{"good":1,)" + test::Members(20, "bad", "\"x\"") + "}}");
  EXPECT_EQ(test::BodyOf<model::cyberwave::Joints>(judgement).joints.size(), 1U);
  EXPECT_EQ(judgement.dropped.size(), schema::kDroppedFieldsListedMax);
  ASSERT_EQ(judgement.unlisted.size(), 1U);
  EXPECT_EQ(judgement.unlisted.front().fields, 20 - schema::kDroppedFieldsListedMax);
}

}  // namespace
}  // namespace uplink::cyberwave
