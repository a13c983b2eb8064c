// What rejects a message: each rule by its name, with a payload that keeps it and one that breaks
// it. Content rejects in durable messages; in live ones see dropping_test.cc.
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::RejectReason;
using test::Items;
using test::JudgeOn;
using test::Long;
using test::Members;
using test::NameOf;
using test::Rule;

std::string Lists(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }
std::string Sized(std::size_t bytes) {
  const std::string rest = R"({"status":"ok","x":""})";
  return R"({"status":"ok","x":")" + std::string(bytes - rest.size(), 'a') + "\"}";
}
std::string Event(const std::string& data) { return R"({"event_type":"e","data":)" + data + "}"; }
std::string Environment(const std::string& members) { return "{" + members + R"(,"data":{}})"; }
std::string Log(const std::string& members) {
  return R"({"level":"INFO",)" + members + R"(,"source":"edge"})";
}
std::string Run(const std::string& members) { return R"({"action_id":"a",)" + members + "}"; }
std::string Mission(const std::string& members) {
  return R"({"mission_execution_uuid":"m",)" + members + "}";
}
std::string Health(const std::string& members) { return "{" + members + "}"; }
std::string Metrics(const std::string& members) {
  return R"({"source_type":"edge","metrics":{)" + members + "}}";
}
std::string Streams(std::size_t count) {
  return R"({"streams":{)" + Members(count, "s", "{}") + "}}";
}

class Rejecting : public ::testing::TestWithParam<Rule> {};

TEST_P(Rejecting, TheGoodMessagePassesAndTheBadOneIsRejected) {
  const Rule& rule = GetParam();
  const Judgement good = JudgeOn(rule.tail, rule.good);
  EXPECT_EQ(good.rejection(), nullptr) << good.rejection()->field << good.rejection()->detail;
  EXPECT_TRUE(good.dropped.empty());
  const Judgement bad = JudgeOn(rule.tail, rule.bad);
  ASSERT_NE(bad.rejection(), nullptr);
  EXPECT_EQ(bad.rejection()->reason, rule.reason) << bad.rejection()->detail;
  EXPECT_EQ(bad.rejection()->field, rule.field);
  EXPECT_FALSE(bad.rejection()->detail.empty());
  EXPECT_TRUE(bad.dropped.empty());
}

constexpr auto kOk = R"({"status":"ok"})";

INSTANTIATE_TEST_SUITE_P(
    Structure, Rejecting,
    ::testing::Values(
        Rule{"size", "workflow-run", Sized(65'536), Sized(65'537), RejectReason::kPayloadTooLarge,
             ""},
        Rule{"json", "workflow-run", kOk, "{", RejectReason::kMalformed, ""},
        Rule{"nothing after it", "workflow-run", std::string(kOk) + " \n", std::string(kOk) + "x",
             RejectReason::kMalformed, ""},
        Rule{"not empty", "workflow-run", kOk, "", RejectReason::kMalformed, ""},
        Rule{"not blank", "position", R"({"position":{"x":1,"y":2,"z":3}})", " ",
             RejectReason::kMalformed, ""},
        Rule{"no bare NaN", "event", Event("null"), Event("NaN"), RejectReason::kMalformed, ""},
        Rule{"no bare NaN in live ones", "gps", R"({"altitude":null})", R"({"altitude":NaN})",
             RejectReason::kMalformed, ""},
        Rule{"no bare Infinity", "gps", R"({"altitude":1})", R"({"altitude":-Infinity})",
             RejectReason::kMalformed, ""},
        Rule{"depth", "event", Event(Lists(31)), Event(Lists(32)), RejectReason::kMalformed, ""},
        Rule{"depth of live ones", "gps", R"({"altitude":1,"x":)" + Lists(31) + "}",
             R"({"altitude":1,"x":)" + Lists(32) + "}", RejectReason::kMalformed, ""},
        Rule{"utf-8", "event", Event("\"\xC3\xBC\""), Event("\"\xFF\""), RejectReason::kTextNotUtf8,
             ""},
        Rule{"whole surrogates", "event", Event(R"("\ud83d\ude00")"), Event(R"("\ud83d")"),
             RejectReason::kTextNotUtf8, ""},
        Rule{"no high surrogate before other escapes", "event", Event(R"("\\ud83d")"),
             Event(R"("\ud83d\n and more behind it")"), RejectReason::kTextNotUtf8, ""},
        Rule{"no two high surrogates", "event", Event(R"("\u00e4")"), Event(R"("\ud83d\ud83d")"),
             RejectReason::kTextNotUtf8, ""},
        Rule{"no low surrogate alone", "gps", R"({"altitude":1,"x":"\u0041"})",
             R"({"altitude":1,"x":"\ude00"})", RejectReason::kTextNotUtf8, ""},
        Rule{"no escape that is none", "event", Event(R"("\u00e4")"), Event(R"("\u00g4")"),
             RejectReason::kMalformed, ""},
        Rule{"an object", "workflow-run", kOk, "[]", RejectReason::kTypeMismatch, ""},
        Rule{"an object, not null", "gps", "{}", "null", RejectReason::kTypeMismatch, ""},
        Rule{"exponents within bounds", "gps", R"({"altitude":1e-400})",
             R"({"altitude":1e99999999999})", RejectReason::kNotFinite, ""}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Durable, Rejecting,
    ::testing::Values(
        Rule{"telemetry type", "telemetry", R"({"type":"camera_stored"})", R"({"timestamp":1})",
             RejectReason::kMissingField, "type"},
        Rule{"telemetry type not null", "telemetry", R"({"type":"x"})", R"({"type":null})",
             RejectReason::kMissingField, "type"},
        Rule{"telemetry type not empty", "telemetry", R"({"type":"x"})", R"({"type":""})",
             RejectReason::kMissingField, "type"},
        Rule{"telemetry type a text", "telemetry", R"({"type":"1"})", R"({"type":1})",
             RejectReason::kTypeMismatch, "type"},
        Rule{"telemetry type length", "telemetry", R"({"type":)" + Long(256) + "}",
             R"({"type":)" + Long(257) + "}", RejectReason::kTextTooLong, "type"},
        Rule{"mark sensor length", "telemetry",
             R"({"type":"telemetry_end","sensor":)" + Long(128) + "}",
             R"({"type":"telemetry_end","sensor":)" + Long(129) + "}", RejectReason::kTextTooLong,
             "sensor"},
        Rule{"mark boundary a boolean", "telemetry",
             R"({"type":"telemetry_end","recording_boundary":true})",
             R"({"type":"telemetry_end","recording_boundary":1})", RejectReason::kTypeMismatch,
             "recording_boundary"},
        Rule{"event type", "event", Event("{}"), R"({"data":{}})", RejectReason::kMissingField,
             "event_type"},
        Rule{"event numbers within a double", "event", Event(R"({"n":[1e300]})"),
             Event(R"({"n":[1e400]})"), RejectReason::kNotFinite, "data.n[0]"},
        Rule{"event texts without NUL", "event", Event(R"({"n":{"m":"\t"}})"),
             Event(R"({"n":{"m":"\u0000"}})"), RejectReason::kTextNotUtf8, "data.n.m"},
        Rule{"event names without NUL", "event", Event(R"({"n":1})"), Event(R"({"n\u0000":1})"),
             RejectReason::kTextNotUtf8, R"(data.n\x00)"},
        Rule{"session length", "event", R"({"event_type":"e","session_id":)" + Long(128) + "}",
             R"({"event_type":"e","session_id":)" + Long(129) + "}", RejectReason::kTextTooLong,
             "session_id"},
        Rule{"session a text", "event", R"({"event_type":"e","session_id":"1"})",
             R"({"event_type":"e","session_id":1})", RejectReason::kTypeMismatch, "session_id"},
        Rule{"source_type length", "event", R"({"event_type":"e","source_type":)" + Long(256) + "}",
             R"({"event_type":"e","source_type":)" + Long(257) + "}", RejectReason::kTextTooLong,
             "source_type"},
        Rule{"source_type a text", "event", R"({"event_type":"e","source_type":"x"})",
             R"({"event_type":"e","source_type":true})", RejectReason::kTypeMismatch,
             "source_type"},
        Rule{"log message", "driverlog", Log(R"("message":"m")"), Log(R"("x":"m")"),
             RejectReason::kMissingField, "message"},
        Rule{"log message not empty", "driverlog", Log(R"("message":" ")"), Log(R"("message":"")"),
             RejectReason::kMissingField, "message"},
        Rule{"log message length", "driverlog", Log("\"message\":" + Long(8192)),
             Log("\"message\":" + Long(8193)), RejectReason::kTextTooLong, "message"},
        Rule{"log level", "driverlog", R"({"message":"m","level":"x"})", R"({"message":"m"})",
             RejectReason::kMissingField, "level"},
        Rule{"log container length", "driverlog",
             Log(R"("message":"m","container_name":)" + Long(256)),
             Log(R"("message":"m","container_name":)" + Long(257)), RejectReason::kTextTooLong,
             "container_name"},
        Rule{"log version length", "driverlog", Log(R"("message":"m","sdk_version":)" + Long(256)),
             Log(R"("message":"m","sdk_version":)" + Long(257)), RejectReason::kTextTooLong,
             "sdk_version"},
        Rule{"log by telemetry", "telemetry", R"({"type":"driver_log","message":"m","level":"x"})",
             R"({"type":"driver_log","message":"m"})", RejectReason::kMissingField, "level"},
        Rule{"action id", "navigate/status", Run(R"("status":"queued")"), R"({"status":"queued"})",
             RejectReason::kMissingField, "action_id"},
        Rule{"action id length", "navigate/status",
             R"({"status":"queued","action_id":)" + Long(128) + "}",
             R"({"status":"queued","action_id":)" + Long(129) + "}", RejectReason::kTextTooLong,
             "action_id"},
        Rule{"navigation status", "navigate/status", Run(R"("status":"?")"),
             Run(R"("status":null)"), RejectReason::kMissingField, "status"},
        Rule{"navigation message length", "navigate/status",
             Run(R"("status":"x","message":)" + Long(8192)),
             Run(R"("status":"x","message":)" + Long(8193)), RejectReason::kTextTooLong, "message"},
        Rule{"progress not above", "navigate/status", Run(R"("status":"x","progress":105)"),
             Run(R"("status":"x","progress":105.1)"), RejectReason::kOutOfRange, "progress"},
        Rule{"progress not below", "navigate/status", Run(R"("status":"x","progress":-5)"),
             Run(R"("status":"x","progress":-5.1)"), RejectReason::kOutOfRange, "progress"},
        Rule{"progress a number", "navigate/status", Run(R"("status":"x","progress":1)"),
             Run(R"("status":"x","progress":"1")"), RejectReason::kTypeMismatch, "progress"},
        Rule{"progress no boolean", "navigate/status", Run(R"("status":"x","progress":0)"),
             Run(R"("status":"x","progress":false)"), RejectReason::kTypeMismatch, "progress"},
        Rule{"progress within a double", "navigate/status", Run(R"("status":"x","progress":1)"),
             Run(R"("status":"x","progress":1e999)"), RejectReason::kNotFinite, "progress"},
        Rule{"mission id", "mission/status", Mission(R"("status":"running")"),
             R"({"status":"running"})", RejectReason::kMissingField, "mission_execution_uuid"},
        Rule{"mission status", "mission/status", Mission(R"("status":"running")"),
             Mission(R"("state":"running")"), RejectReason::kMissingField, "status"},
        Rule{"mission step whole", "mission/status", Mission(R"("status":"x","current_step":2.0)"),
             Mission(R"("status":"x","current_step":2.5)"), RejectReason::kTypeMismatch,
             "current_step"},
        Rule{"mission step not below 0", "mission/status",
             Mission(R"("status":"x","current_step":0)"),
             Mission(R"("status":"x","current_step":-1)"), RejectReason::kOutOfRange,
             "current_step"},
        Rule{"environment type", "environment/t", Environment(R"("type":"t")"),
             Environment(R"("x":1)"), RejectReason::kMissingField, "type"},
        Rule{"environment type of the topic", "environment/t", Environment(R"("type":"t")"),
             Environment(R"("type":"T")"), RejectReason::kIdentityMismatch, "type"},
        Rule{"environment data", "environment/t", R"({"type":"t","bindings":[]})",
             R"({"type":"t"})", RejectReason::kMissingField, "data"},
        Rule{"environment data an object", "environment/t", R"({"type":"t","data":{}})",
             R"({"type":"t","data":"x"})", RejectReason::kTypeMismatch, "data"},
        Rule{"workflow status", "workflow-run", R"({"status":"?"})", "{}",
             RejectReason::kMissingField, "status"},
        Rule{"workflow status length", "workflow-run", R"({"status":)" + Long(256) + "}",
             R"({"status":)" + Long(257) + "}", RejectReason::kTextTooLong, "status"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    LiveKeysAndItems, Rejecting,
    ::testing::Values(
        Rule{"metrics there", "metrics", Metrics(""), R"({"source_type":"edge"})",
             RejectReason::kMissingField, "metrics"},
        Rule{"metrics an object", "metrics", Metrics(""), R"({"metrics":[]})",
             RejectReason::kTypeMismatch, "metrics"},
        Rule{"metrics items", "metrics", Metrics("\"a\":{" + Members(256, "m", "1") + "}"),
             Metrics("\"a\":{" + Members(257, "m", "1") + "}"), RejectReason::kTooManyItems,
             "metrics"},
        Rule{"metrics items nested", "metrics",
             Metrics(R"("a":[)" + Items(128, "1") + R"(],"b":{"c":[)" + Items(128, "true") + "]}"),
             Metrics(R"("a":[)" + Items(128, "1") + R"(],"b":{"c":[)" + Items(129, "true") + "]}"),
             RejectReason::kTooManyItems, "metrics"},
        Rule{"metrics errors", "metrics", Metrics(R"("errors":[)" + Items(64, "\"e\"") + "]"),
             Metrics(R"("errors":[)" + Items(65, "\"e\"") + "]"), RejectReason::kTooManyItems,
             "metrics.errors"},
        Rule{"metrics errors a list", "metrics", Metrics(R"("errors":null)"),
             Metrics(R"("errors":"e")"), RejectReason::kTypeMismatch, "metrics.errors"},
        Rule{"metrics error a text", "metrics", Metrics(R"("errors":["e",null])"),
             Metrics(R"("errors":["e",1])"), RejectReason::kTypeMismatch, "metrics.errors[1]"},
        Rule{"metrics error not empty", "metrics", Metrics(R"("errors":["e"])"),
             Metrics(R"("errors":[""])"), RejectReason::kMissingField, "metrics.errors[0]"},
        Rule{"metrics error length", "metrics", Metrics(R"("errors":[)" + Long(8192) + "]"),
             Metrics(R"("errors":[)" + Long(8193) + "]"), RejectReason::kTextTooLong,
             "metrics.errors[0]"},
        Rule{"health twin", "edge_health",
             Health(R"("twin_uuid":"11111111-1111-4111-8111-111111111111")"),
             Health(R"("twin_uuid":"11111111-1111-4111-8111-111111111112")"),
             RejectReason::kIdentityMismatch, "twin_uuid"},
        Rule{"health twin a text", "edge_health", Health(R"("twin_uuid":null)"),
             Health(R"("twin_uuid":1)"), RejectReason::kTypeMismatch, "twin_uuid"},
        Rule{"health twin a uuid", "edge_health", Health(R"("uptime":1)"),
             Health(R"("twin_uuid":"arm")"), RejectReason::kIdentityMismatch, "twin_uuid"},
        Rule{"health edge id length", "edge_health", Health("\"edge_id\":" + Long(128)),
             Health("\"edge_id\":" + Long(129)), RejectReason::kTextTooLong, "edge_id"},
        Rule{"health edge id not empty", "edge_health", Health(R"("edge_uuid":"e")"),
             Health(R"("edge_uuid":"")"), RejectReason::kMissingField, "edge_uuid"},
        Rule{"health streams", "edge_health", Streams(64), Streams(65), RejectReason::kTooManyItems,
             "streams"},
        Rule{"telemetry errors", "telemetry",
             R"({"telemetry_type":"errors","data":{"errors":[)" + Items(64, "{}") + "]}}",
             R"({"telemetry_type":"errors","data":{"errors":[)" + Items(65, "{}") + "]}}",
             RejectReason::kTooManyItems, "data.errors"},
        Rule{"telemetry_type length", "telemetry", R"({"telemetry_type":)" + Long(256) + "}",
             R"({"telemetry_type":)" + Long(257) + "}", RejectReason::kTextTooLong,
             "telemetry_type"},
        Rule{"telemetry_type a text", "telemetry", R"({"telemetry_type":"1"})",
             R"({"telemetry_type":1})", RejectReason::kTypeMismatch, "telemetry_type"},
        Rule{"ping type", "ping", R"({"type":"anything"})", R"({"timestamp":1})",
             RejectReason::kMissingField, "type"},
        Rule{"command json", "command", "{}", "go", RejectReason::kMalformed, ""},
        Rule{"command an object", "navigate/command", "{}", R"("stop")",
             RejectReason::kTypeMismatch, ""}),
    NameOf);

}  // namespace
}  // namespace uplink::cyberwave
