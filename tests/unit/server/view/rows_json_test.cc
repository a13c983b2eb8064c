#include "server/view/rows_json.h"

#include <cmath>
#include <string>

#include <boost/json.hpp>
#include <gtest/gtest.h>

#include "server/view/json.h"
#include "server/view/messages.h"
#include "server/view/page_token.h"
#include "server/view/timestamps.h"
#include "tests/support/exact_json.h"

// Rows of the store as JSON, every member.
namespace uplink::view {
namespace {

using boost::json::object;

const model::RobotId kRobot{"rcan://a", "f"};

template <typename Row>
void ExpectJson(const std::string& list, Row row, const std::string& expected) {
  row.robot = kRobot;
  storage::Page<Row> page;
  page.rows.push_back(std::move(row));
  page.next_token = "t";
  const auto json = ToJson(page);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(test::ParseExact(*json),
            test::ParseExact("{\"" + list + "\": [" + expected + "], \"nextPageToken\": \"t\"}"))
      << *json;
}

TEST(RowsJson, Events) {
  storage::EventRow row;
  row.kind = "modeChanged";
  row.detail_json = R"({"from":"manual","to":"auto"})";
  row.sampled_at_ms = 1;
  row.received_at = FromUnixMs(2);
  ExpectJson("events", row, R"({"ruri": "rcan://a", "kind": "modeChanged",
    "detail": {"from": "manual", "to": "auto"}, "sampledAt": "1970-01-01T00:00:00.001Z", "receivedAt": "1970-01-01T00:00:00.002Z"})");
}

TEST(RowsJson, AnEventThatHoldsNothingHasAnEmptyDetail) {
  storage::EventRow row;
  row.kind = "estopReleased";
  row.detail_json = "{}";
  ExpectJson("events", row, R"({"ruri": "rcan://a", "kind": "estopReleased", "detail": {}})");
}

TEST(RowsJson, Messages) {
  storage::MessageRow row;
  row.message = {.unix_time_ms = 1, .level = model::MessageLevel::kError, .message = "a \"b\" ä\n"};
  row.received_at = FromUnixMs(2);
  ExpectJson("messages", row, R"({"ruri": "rcan://a", "level": "error",
    "message": "a \"b\" ä\n", "sampledAt": "1970-01-01T00:00:00.001Z", "receivedAt": "1970-01-01T00:00:00.002Z"})");
}

TEST(RowsJson, AMessageShowsTheDetailThatItsSenderGave) {
  storage::MessageRow row;
  row.message = {.message = "gripper is warm", .detail_json = R"({"source":"arm","axis":3})"};
  ExpectJson("messages", row, R"({"ruri": "rcan://a", "level": "info",
    "message": "gripper is warm",
    "detail": {"source": "arm", "axis": 3}})");
  row.message.detail_json = "{}";
  ExpectJson("messages", row, R"({"ruri": "rcan://a", "level": "info",
    "message": "gripper is warm", "detail": {}})");
}

TEST(RowsJson, ScopeUpdates) {
  storage::ScopeUpdateRow row;
  row.update = {.scope = model::ScopeKind::kWorkflowRun,
                .id = "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee",
                .type = "running",
                .detail_json = R"({"status":"running","step":2})",
                .unix_time_ms = 1};
  row.received_at = FromUnixMs(2);
  ExpectJson("scopeUpdates", row, R"({"scope": "workflow_run",
    "id": "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee", "type": "running",
    "detail": {"status": "running", "step": 2}, "sampledAt": "1970-01-01T00:00:00.001Z", "receivedAt": "1970-01-01T00:00:00.002Z"})");
}

TEST(RowsJson, PresenceChanges) {
  for (const auto& [presence, name] : {std::pair{model::Presence::kUnknown, "unknown"},
                                       std::pair{model::Presence::kOnline, "online"},
                                       std::pair{model::Presence::kOffline, "offline"}}) {
    storage::PresenceRow row;
    row.presence = presence;
    row.at = FromUnixMs(3);
    ExpectJson("presenceChanges", row,
               R"({"ruri": "rcan://a", "presence": ")" + std::string(name) +
                   R"(", "at": "1970-01-01T00:00:00.003Z", "why": ""})");
  }
}

TEST(RowsJson, APresenceChangeShowsWhyTheLastConnectionEnded) {
  storage::PresenceRow row;
  row.presence = model::Presence::kOffline;
  row.at = FromUnixMs(3);
  row.why = model::ConnectionEnd::kNotRead;
  ExpectJson("presenceChanges", row, R"({"ruri": "rcan://a", "presence": "offline",
    "at": "1970-01-01T00:00:00.003Z", "why": "not_read"})");
}

TEST(RowsJson, Connections) {
  storage::ConnectionRow row;
  row.id = {0xAB};
  row.began_at = FromUnixMs(1);
  row.server = "host:7443";
  row.address = "192.0.2.1:4711";
  row.messages = 5;
  row.bytes = 6;
  const std::string open = R"({"ruri": "rcan://a", "id": "ab000000000000000000000000000000",
    "source": "uplink", "beganAt": "1970-01-01T00:00:00.001Z", "server": "host:7443",
    "address": "192.0.2.1:4711", "gateway": "", "agentVersion": "", "messages": "5", "bytes": "6",
    "takeovers": 0)";
  ExpectJson("connections", row, open + "}");
  row.certificate = {
      .serial = "0A", .sha256 = "aa", .key_sha256 = "bb", .not_after = FromUnixMs(4)};
  row.held_back_ms = 7;
  row.held_back_why = "flow";
  row.ended_at = FromUnixMs(2);
  row.why = model::ConnectionEnd::kReplaced;
  row.code = "ABORTED";
  row.detail = "superseded";
  ExpectJson("connections", row, open + R"(,
    "certificate": {"serial": "0A", "sha256": "aa", "keySha256": "bb",
                    "notAfter": "1970-01-01T00:00:00.004Z"},
    "heldBack": {"totalMs": "7", "why": "flow"},
    "end": {"at": "1970-01-01T00:00:00.002Z", "why": "replaced", "code": "ABORTED",
            "detail": "superseded"}})");
}

TEST(RowsJson, MissionRuns) {
  storage::MissionRunRow row;
  row.mission_id = "m";
  row.run_id = "r";
  row.name = "north field";
  row.status = model::MissionStatus::kBlocked;
  row.latest_json = R"({"unixTimeMs":5,"runId":"r"})";
  row.first_received_at = FromUnixMs(6);
  row.last_received_at = FromUnixMs(7);
  row.updates = 3;
  ExpectJson("missions", row, R"({"ruri": "rcan://a", "missionId": "m", "runId": "r",
    "name": "north field", "status": "blocked", "latest": {"unixTimeMs": 5, "runId": "r"},
    "firstReceivedAt": "1970-01-01T00:00:00.006Z", "lastReceivedAt": "1970-01-01T00:00:00.007Z", "updates": "3", "closedWhy": ""})");
}

TEST(RowsJson, MissionReports) {
  storage::MissionReportRow row;
  row.mission_id = "m";
  row.run_id = "r";
  row.status = model::MissionStatus::kPaused;
  row.report_json = R"({"unixTimeMs":5,"runId":"r"})";
  row.received_at = FromUnixMs(1'777'636'800'250);
  ExpectJson("missionReports", row, R"({"ruri": "rcan://a", "missionId": "m", "runId": "r",
    "status": "paused", "report": {"unixTimeMs": 5, "runId": "r"},
    "receivedAt": "2026-05-01T12:00:00.250Z"})");
}

TEST(RowsJson, AMissionRunThatTheServerClosedSaysWhyAndWhen) {
  storage::MissionRunRow row;
  row.robot = kRobot;
  row.status = model::MissionStatus::kRunning;
  row.latest_json = "{}";
  row.closed_at_ms = 9;
  for (const auto& [closed, why] : {std::pair{storage::RunClosed::kForBound, "bound"},
                                    std::pair{storage::RunClosed::kForAge, "age"}}) {
    row.closed = closed;
    const v1::MissionRun message = ToMessage(row);
    EXPECT_EQ(message.closed_why(), why);
    EXPECT_EQ(view::UnixMs(message.closed_at()), 9);
    EXPECT_EQ(message.status(), "running") << "as the robot reported it";
  }
}

TEST(RowsJson, Shapes) {
  storage::ShapeRow row;
  row.identity = {.id = "s", .name = "n", .rev = 4'294'967'295, .hash = "h"};
  row.area_type = model::ReportedLayerRole::kHazard;
  row.scope = static_cast<model::ScopeType>(9);
  row.geometry_json = R"({"type":"Point","coordinates":[8.5E0,4.7E1]})";
  row.expires_at_ms = 5;
  row.min_z_m = -1.5;
  row.max_z_m = 2.5;
  row.level_id = -3;
  row.received_at = FromUnixMs(6);
  ExpectJson("shapes", row, R"({"ruri": "rcan://a", "id": "s", "name": "n", "areaType": "hazard",
    "scope": "unrecognized_9", "rev": 4294967295, "hash": "h",
    "geometry": {"type": "Point", "coordinates": [8.5, 47]}, "expiresAt": "1970-01-01T00:00:00.005Z", "minZM": -1.5,
    "maxZM": 2.5, "levelId": -3, "receivedAt": "1970-01-01T00:00:00.006Z"})");
}

TEST(RowsJson, Objects) {
  storage::ObjectRow row;
  row.id = "o";
  row.name = "n";
  row.object_type = model::ObjectType::kAnimal;
  row.scope = model::ScopeType::kWorld;
  row.location_json = R"({"latDeg":47,"lonDeg":8})";
  row.trajectory_json = R"({"speedMps":1,"courseDeg":2,"verticalRateMps":3})";
  row.radius_m = 0.5;
  row.sampled_at_ms = 4;
  row.expires_at_ms = 5;
  row.received_at = FromUnixMs(6);
  const std::string start = R"({"ruri": "rcan://a", "id": "o", "name": "n", "objectType": "animal",
    "scope": "world", "location": {"latDeg": 47, "lonDeg": 8}, "radiusM": 0.5,
    "sampledAt": "1970-01-01T00:00:00.004Z", "expiresAt": "1970-01-01T00:00:00.005Z", "receivedAt": "1970-01-01T00:00:00.006Z")";
  ExpectJson("objects", row,
             start + R"(, "trajectory": {"speedMps": 1, "courseDeg": 2, "verticalRateMps": 3}})");
  row.trajectory_json.clear();
  ExpectJson("objects", row, start + "}");
}

TEST(RowsJson, StoredPartsOfARobotAreShownWhereTheyAreWanted) {
  RobotView robot;
  robot.id = kRobot;
  robot.stored = {.agent_info = R"({"agentVersion":"1"})",
                  .settings = R"({"k":1})",
                  .ui_capabilities = R"({"services":[],"sensors":[],"settings":[]})"};
  const auto all = test::ParseExact(*ToJson(robot, PartSet::All()));
  EXPECT_EQ(all->at("agentInfo"), (object{{"agentVersion", "1"}}));
  EXPECT_EQ(all->at("settings"), (object{{"k", 1.0}}));
  EXPECT_EQ(all->at("uiCapabilities").as_object().size(), 3U);
  PartSet wanted;
  wanted.Add(Part::kSettings);
  const auto one = test::ParseExact(*ToJson(robot, wanted));
  EXPECT_TRUE(one->contains("settings"));
  EXPECT_FALSE(one->contains("agentInfo"));
  EXPECT_FALSE(one->contains("uiCapabilities"));
}

/// A robot whose settings these are in the store, as an answer.
std::string WithSettings(const std::string& text) {
  RobotView robot;
  robot.id = kRobot;
  robot.stored.settings = text;
  return *ToJson(robot, PartSet::All());
}

TEST(RowsJson, WhatTheStoreKeepsStandsInTheAnswerAsItIs) {
  const std::string text =
      R"({"b":1.5E0,"a":{"z":-0,"y":[]},"e":"\u00e4 \"","i":9223372036854775807})";
  const std::string json = WithSettings(text);
  EXPECT_TRUE(json.ends_with(",\"settings\":" + text + "}")) << json;
  EXPECT_TRUE(test::ParseExact(json)) << json;

  storage::Page<storage::EventRow> page;
  for (int i = 0; i < 2; ++i) page.rows.emplace_back().detail_json = text;
  const std::string list = *ToJson(page);
  const std::string item = R"({"ruri":"","kind":"","detail":)";
  EXPECT_EQ(list,
            "{\"events\":[" + item + text + "}," + item + text + "}],\"nextPageToken\":\"\"}");
}

TEST(RowsJson, DoublesComeBackToTheLastBit) {
  // Values at which a reader that computes mantissa times power of ten is off by one.
  for (const double x : {-172.43127776997827, 47.376887, 8.541694, 1e-7, 5e-324,
                         1.7976931348623157e308, std::nextafter(0.1, 1.0)}) {
    const auto robot = test::ParseExact(WithSettings(boost::json::serialize(object{{"x", x}})));
    EXPECT_EQ(robot->at("settings").at("x").as_double(), x);
  }
}

TEST(RowsJson, ATextThatIsNoObjectIsShownAsAnEmptyOne) {
  for (const char* text : {"", "{", "[1]", "1", "{\"a\":1}x", "{\"a\":1},\"ruri\":{}",
                           "{\"a\":\"\xff\"}", "{\"a\":01}", "{a:1}"}) {
    const std::string json = WithSettings(text);
    EXPECT_TRUE(json.ends_with(",\"settings\":{}}")) << json;
  }
}

TEST(RowsJson, APageOfRobotsEndsOnceItsTextIsLargeAndGoesOnByToken) {
  RobotsPage page;
  const std::string settings = R"({"k":")" + std::string(storage::kPageBytesMax / 4, 'x') + "\"}";
  for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c", "rcan://d", "rcan://e"}) {
    RobotView& robot = page.robots.emplace_back();
    robot.id = {ruri, "f"};
    robot.stored.settings = settings;
    robot.next_token = RobotsToken(ruri);
  }
  page.next_token = RobotsToken("rcan://e");
  const auto json = test::ParseExact(*ToJson(page, PartSet::All()));
  EXPECT_EQ(json->at("robots").as_array().size(), 4U);
  EXPECT_EQ(json->at("nextPageToken").as_string(), RobotsToken("rcan://d"));
  page.robots.pop_back();
  page.next_token.clear();
  const auto whole = test::ParseExact(*ToJson(page, PartSet::All()));
  EXPECT_EQ(whole->at("robots").as_array().size(), 4U) << "the last one may pass the bound";
  EXPECT_EQ(whole->at("nextPageToken").as_string(), "");
}

}  // namespace
}  // namespace uplink::view
