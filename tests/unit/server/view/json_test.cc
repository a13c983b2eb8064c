#include "server/view/json.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include "server/fleet/fleet.h"
#include "server/view/error_json.h"
#include "server/view/parts.h"
#include "server/view/rows_json.h"
#include "server/view/timestamps.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::view {
namespace {

google::protobuf::Struct Parse(const std::string& json) {
  google::protobuf::Struct parsed;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &parsed);
  EXPECT_TRUE(status.ok()) << json;
  return parsed;
}

/// The order of members does not count.
void ExpectSameJson(const std::string& actual, const std::string& expected) {
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(Parse(actual), Parse(expected)))
      << "actual:   " << actual << "\nexpected: " << expected;
}

RobotView EmptyRobot() {
  RobotView robot;
  robot.id = {"rcan://a/b", "north"};
  robot.state.presence_since = FromUnixMs(1000);
  return robot;
}

robot::LiveParts EveryPart() {
  robot::RobotState state(SteadyTime(), SteadyTime(), FromUnixMs(0));
  std::vector<model::Record> records;
  records.push_back(uplink::test::RecordOf(model::MotionTelemetry{
      .unix_time_ms = 11,
      .pose = model::Pose{.lat_deg = 47.5, .lon_deg = 8.25, .heading_deg = 90.0},
      .velocity = model::VelTwist{.linear_mps = 1.5F, .angular_rps = 0.25F}}));
  model::StatusTelemetry status;
  status.unix_time_ms = 12;
  status.mode = model::RobotMode::kAuto;
  status.status = "fine";
  records.push_back(uplink::test::RecordOf(status));
  records.push_back(uplink::test::RecordOf(model::TelemetryExtras{
      .unix_time_ms = 13,
      .kv = {{.key = "blade", .value = true}, {.key = "rpm", .value = 2.5, .unix_time_ms = 14}}}));
  records.push_back(uplink::test::RecordOf(
      model::SystemHealth{.unix_time_ms = 15, .device_id = "main", .cpu_pct = 12.5F}));
  model::UsageTelemetry usage;
  usage.unix_time_ms = 16;
  usage.total_distance_m = 1000.5;
  usage.auto_distance_m = 1000;
  usage.manual_distance_m = 0.5;
  usage.uptime_total_s = 5;
  usage.drive_time_total_s = 4;
  usage.auto_time_total_s = 3;
  usage.reboot_count = 2;
  records.push_back(uplink::test::RecordOf(usage));
  records.push_back(uplink::test::RecordOf(model::ConsumableStatus{.unix_time_ms = 17,
                                                                   .kind = "paint",
                                                                   .tank_id = "left",
                                                                   .level_pct = 50,
                                                                   .amount_remaining = 2,
                                                                   .unit = "l"}));
  records.push_back(uplink::test::RecordOf(model::SpatialDirectiveStatus{
      .directive_id = "d1", .last_eval_time_ms = 18, .active = true, .inside_zone = true}));
  state.Apply(records, {});
  return state.Snapshot(robot::RobotState::Parts::kAll).parts;
}

TEST(Json, ARobotThatSaidNothingPrintsItsDefaults) {
  ExpectSameJson(*ToJson(EmptyRobot(), PartSet::All()), R"({
    "ruri": "rcan://a/b", "fleet": "north", "source": "uplink", "presence": "unknown",
    "presenceSince": "1970-01-01T00:00:01Z", "connected": false, "sessionId": "", "settledSeq": "0",
    "activeFaults": 0, "operatorRequestsOpen": 0, "fieldsDropped": "0", "uplinksMissing": "0",
    "heldBy": "", "heldBack": "", "contested": false, "flapping": false, "gateway": "",
    "agentVersion": "", "rateLimited": {},
    "labels": {}, "note": "", "blocked": false, "registered": false})");
}

TEST(Json, ARobotShowsHowFarBehindItIs) {
  RobotView robot = EmptyRobot();
  const auto backlog = [&robot] {
    const google::protobuf::Struct json = Parse(*ToJson(robot, PartSet::OfLists()));
    return json.fields().at("backlog");
  };
  robot.state.backlog = {
      .uplinks = 12, .oldest_unsent = FromUnixMs(1600), .said_at = FromUnixMs(1700)};
  EXPECT_EQ(backlog().struct_value().fields().at("uplinks").string_value(), "12");
  EXPECT_EQ(backlog().struct_value().fields().at("oldestUnsent").string_value(),
            "1970-01-01T00:00:01.600Z");
  EXPECT_EQ(backlog().struct_value().fields().at("saidAt").string_value(),
            "1970-01-01T00:00:01.700Z");
  robot.state.backlog = {.uplinks = 0, .said_at = FromUnixMs(1700)};
  EXPECT_EQ(backlog().struct_value().fields().at("uplinks").string_value(), "0");
  EXPECT_FALSE(backlog().struct_value().fields().contains("oldestUnsent"));
}

TEST(Json, ARobotThatIsParkedOrFlapsSaysSo) {
  RobotView robot = EmptyRobot();
  EXPECT_FALSE(ToMessage(robot).has_parked_until());
  robot.state.parked_until = FromUnixMs(1600);
  robot.state.flapping = true;
  const google::protobuf::Struct json = Parse(*ToJson(robot, PartSet::OfLists()));
  EXPECT_EQ(json.fields().at("parkedUntil").string_value(), "1970-01-01T00:00:01.600Z");
  EXPECT_TRUE(json.fields().at("flapping").bool_value());
}

TEST(Json, ARobotThatIsHeldBackOrContestedSaysSo) {
  RobotView robot = EmptyRobot();
  robot.session.held_back_since = FromUnixMs(1700);
  EXPECT_FALSE(ToMessage(robot).has_held_back_since()) << "it is read again";
  robot.session.contested = true;
  EXPECT_TRUE(ToMessage(robot).contested());
  robot.rate_limited[static_cast<std::size_t>(model::Variant::kShape)] = 7;
  const v1::Robot limited = ToMessage(robot);
  ASSERT_EQ(limited.rate_limited_size(), 1);
  EXPECT_EQ(limited.rate_limited().at("shape"), 7);
  const std::vector<std::pair<robot::HeldBack, std::string>> words = {
      {robot::HeldBack::kNone, ""},
      {robot::HeldBack::kInFlight, "in_flight"},
      {robot::HeldBack::kJournal, "journal"},
      {robot::HeldBack::kUnread, "unread"},
      {robot::HeldBack::kMalformed, "malformed"}};
  for (const auto& [by, word] : words) {
    robot.session.held_back = by;
    const v1::Robot message = ToMessage(robot);
    EXPECT_EQ(message.held_back(), word);
    EXPECT_EQ(view::UnixMs(message.held_back_since()), word.empty() ? 0 : 1700) << word;
  }
}

TEST(Json, ARobotWithEveryPart) {
  RobotView robot = EmptyRobot();
  robot.state.presence = robot::Presence::kOnline;
  robot.state.last_sign_of_life = FromUnixMs(2000);
  robot.state.clock_skew_ms = -250;
  robot.state.fields_dropped = 3;
  robot.session.connected = true;
  robot.session.connected_since = FromUnixMs(1500);
  robot.session.session = model::SessionId::FromHex("000102030405060708090a0b0c0d0e0f");
  robot.session.settled_seq = 9'007'199'254'740'993;
  robot.session.missing = 4;
  robot.active_faults = 2;
  robot.state.parts = EveryPart();
  ExpectSameJson(*ToJson(robot, PartSet::All()), R"({
    "ruri": "rcan://a/b", "fleet": "north", "source": "uplink", "presence": "online",
    "presenceSince": "1970-01-01T00:00:01Z", "lastSignOfLife": "1970-01-01T00:00:02Z", "connected": true,
    "connectedSince": "1970-01-01T00:00:01.500Z", "sessionId": "000102030405060708090a0b0c0d0e0f",
    "settledSeq": "9007199254740993", "clockSkewMs": "-250", "activeFaults": 2,
    "operatorRequestsOpen": 0, "fieldsDropped": "3", "uplinksMissing": "4", "heldBy": "",
    "heldBack": "", "contested": false, "flapping": false, "gateway": "", "agentVersion": "", "rateLimited": {},
    "labels": {}, "note": "", "blocked": false, "registered": false,
    "motion": {"unixTimeMs": 11, "pose": {"latDeg": 47.5, "lonDeg": 8.25, "headingDeg": 90},
               "velocity": {"linearMps": 1.5, "angularRps": 0.25}, "gpsSource": "real"},
    "status": {"unixTimeMs": 12, "mode": "auto", "faulted": false, "missionActive": false,
               "status": "fine"},
    "extras": {"blade": {"value": true, "sampledAt": "1970-01-01T00:00:00.013Z"},
               "rpm": {"value": 2.5, "sampledAt": "1970-01-01T00:00:00.014Z"}},
    "health": {"main": {"unixTimeMs": 15, "deviceId": "main", "cpuPct": 12.5}},
    "usage": {"unixTimeMs": 16, "totalDistanceM": 1000.5, "autoDistanceM": 1000,
              "manualDistanceM": 0.5, "uptimeTotalS": 5, "driveTimeTotalS": 4,
              "autoTimeTotalS": 3, "missionCountTotal": 0, "chargeCyclesTotal": 0,
              "rebootCount": 2, "lastRebootUnixTimeMs": 0},
    "consumables": {"paint/left": {"unixTimeMs": 17, "kind": "paint", "tankId": "left",
                    "levelPct": 50, "amountRemaining": 2, "unit": "l", "isCritical": false}},
    "directives": {"d1": {"directiveId": "d1", "lastEvalTimeMs": 18, "active": true,
                   "insideZone": true}}})");
}

TEST(Json, OnlyTheWantedPartsAreShown) {
  RobotView robot = EmptyRobot();
  robot.state.parts = EveryPart();
  PartSet wanted;
  wanted.Add(Part::kHealth);
  const google::protobuf::Struct json = Parse(*ToJson(robot, wanted));
  EXPECT_EQ(json.fields().count("health"), 1U);
  for (const char* other : {"motion", "status", "extras", "usage", "consumables", "directives"}) {
    EXPECT_EQ(json.fields().count(other), 0U) << other;
  }
}

TEST(Json, EveryPartOfTheContractHasItsName) {
  std::size_t known = 0;
  for (const char* name :
       {"agentInfo", "settings", "uiCapabilities", "motion", "status", "extras", "health", "usage",
        "consumables", "directives", "rcanState", "cyberwave", "uncrew"}) {
    const std::optional<Part> part = PartFromText(name);
    ASSERT_TRUE(part) << name;
    EXPECT_EQ(static_cast<std::size_t>(*part), known++);
    EXPECT_NE(v1::Robot::descriptor()->FindFieldByCamelcaseName(name), nullptr) << name;
  }
  EXPECT_EQ(known, kParts);
  EXPECT_FALSE(PartFromText("Motion"));
}

TEST(Json, RowsOfQuarantineHoldBytesAsBase64) {
  storage::Page<storage::QuarantineRow> page;
  page.rows.push_back({.robot = {"rcan://a", "f"},
                       .session = {},
                       .seq = 7,
                       .rejection = {model::RejectReason::kOutOfRange, "pose.latDeg", "too far"},
                       .received_at = FromUnixMs(5),
                       .payload = std::string("\xff\x00", 2),
                       .payload_bytes = 2});
  page.next_token = "t";
  ExpectSameJson(*ToJson(page), R"({"quarantined": [{"ruri": "rcan://a",
    "sessionId": "00000000000000000000000000000000", "seq": "7", "reason": "out_of_range",
    "field": "pose.latDeg", "detail": "too far", "receivedAt": "1970-01-01T00:00:00.005Z", "payload": "/wA=",
    "payloadBytes": "2", "source": "uplink", "topic": ""}], "nextPageToken": "t",
    "droppedByReason": {}})");
}

TEST(Json, QuarantineOfNoRobotNamesItsTopic) {
  storage::Page<storage::QuarantineRow> page;
  page.rows.push_back({.robot = {storage::NoRobotOf("local"), "f"},
                       .session = {},
                       .seq = 7,
                       .rejection = {model::RejectReason::kMalformed, "", ""},
                       .received_at = FromUnixMs(5),
                       .payload = "",
                       .payload_bytes = 2,
                       .source = model::MessageSource::kCyberwave,
                       .topic = "localcyberwave/twin/x/event"});
  ExpectSameJson(*ToJson(page), R"({"quarantined": [{"ruri": "",
    "sessionId": "00000000000000000000000000000000", "seq": "7", "reason": "malformed",
    "field": "", "detail": "", "receivedAt": "1970-01-01T00:00:00.005Z", "payload": "", "payloadBytes": "2",
    "source": "cyberwave", "topic": "localcyberwave/twin/x/event"}], "nextPageToken": "",
    "droppedByReason": {}})");
}

TEST(Json, QuarantineOfARobotSaysHowManyRowsWentForWhichReason) {
  const QuarantineView quarantine{
      .page = {},
      .dropped = {{model::RejectReason::kMalformed, 3}, {model::RejectReason::kOutOfRange, 10}}};
  ExpectSameJson(*ToJson(quarantine), R"({"quarantined": [], "nextPageToken": "",
    "droppedByReason": {"malformed": "3", "out_of_range": "10"}})");
}

TEST(Json, FaultsShowWhenTheyWereRaisedOnlyInTheActiveSet) {
  storage::Page<storage::FaultRow> page;
  page.rows.push_back({.robot = {"rcan://a", "f"},
                       .fault = {.unix_time_ms = 1,
                                 .fault_id = "E1",
                                 .source = "arm",
                                 .severity = model::FaultSeverity::kMajor,
                                 .active = true},
                       .received_at = FromUnixMs(2),
                       .raised_at = FromUnixMs(3)});
  page.rows.push_back(page.rows.front());
  page.rows.back().raised_at.reset();
  const std::string start = R"({"ruri": "rcan://a", "faultId": "E1", "source": "arm",
    "severity": "major", "active": true, "category": "", "description": "",
    "suggestedAction": "", "sampledAt": "1970-01-01T00:00:00.001Z",
    "receivedAt": "1970-01-01T00:00:00.002Z")";
  ExpectSameJson(*ToJson(page), "{\"faults\": [" + start +
                                    R"(, "raisedAt": "1970-01-01T00:00:00.003Z"}, )" + start +
                                    "}], \"nextPageToken\": \"\"}");
}

TEST(Json, EmptyListsArePrinted) {
  ExpectSameJson(*ToJson(storage::Page<storage::GapRow>()), R"({"gaps": [], "nextPageToken": ""})");
}

TEST(Json, StatusHoldsEveryColumnOfTheLaw) {
  StatusView status;
  status.version = "1.2.3";
  metrics::MessageCounts& relayed = status.messages[0];
  relayed.received = 1;
  relayed.in_flight = 1;
  status.messages[1].received = 2;
  status.messages[1].ignored = 2;
  const google::protobuf::Struct json = Parse(*ToJson(status, {"store"}));
  const auto& uplinks = json.fields().at("uplinks").struct_value().fields();
  EXPECT_EQ(uplinks.size(), 7U);
  EXPECT_EQ(uplinks.at("received").string_value(), "1");
  EXPECT_EQ(uplinks.at("inFlight").string_value(), "1");
  EXPECT_EQ(json.fields().at("rejectsByReason").struct_value().fields().size(),
            model::kRejectReasons);
  const auto& all = json.fields().at("messages").struct_value().fields();
  EXPECT_EQ(all.at("counts").struct_value().fields().size(), metrics::kBecame.size() + 2);
  EXPECT_EQ(all.at("counts").struct_value().fields().at("received").string_value(), "3");
  EXPECT_EQ(all.at("rejectsByReason").struct_value().fields().size(), model::kRejectReasons);
  const auto& sources = json.fields().at("messagesBySource").struct_value().fields();
  EXPECT_EQ(sources.size(), model::kAllMessageSources.size());
  const auto& twins = sources.at("cyberwave").struct_value().fields().at("counts").struct_value();
  EXPECT_EQ(twins.fields().at("ignored").string_value(), "2");
  EXPECT_EQ(json.fields().at("robots").struct_value().fields().size(), 3U);
  EXPECT_EQ(json.fields().at("degraded").list_value().values(0).string_value(), "store");
}

TEST(Json, StatusShowsWhatIsDoneAtABroker) {
  StatusView status;
  EXPECT_EQ(Parse(*ToJson(status, {})).fields().count("mqtt"), 0U);
  status.broker = BrokerStatus{.url = "mqtts://broker:8883",
                               .holds_lease = true,
                               .held_by = "a:1",
                               .prefixes = {"", "local"},
                               .twins = 3,
                               .subscribed_since = FromUnixMs(7),
                               .connections = {{.name = "durable",
                                                .client_id = "uplinkd",
                                                .state = "subscribed",
                                                .connected_since = FromUnixMs(6),
                                                .session_present = true,
                                                .unacked = 5,
                                                .filters_refused = 1,
                                                .filters_lower = 2,
                                                .last_error = "keepalive",
                                                .last_error_at = FromUnixMs(4)},
                                               {.name = "live"}}};
  const google::protobuf::Struct json = Parse(*ToJson(status, {}));
  google::protobuf::Struct mqtt = json.fields().at("mqtt").struct_value();
  std::string text;
  ASSERT_TRUE(google::protobuf::util::MessageToJsonString(mqtt, &text).ok());
  ExpectSameJson(text, R"({
    "url": "mqtts://broker:8883", "holdsLease": true, "heldBy": "a:1", "prefixes": ["", "local"],
    "twins": "3", "subscribedSince": "1970-01-01T00:00:00.007Z",
    "connections": [
      {"name": "durable", "clientId": "uplinkd", "state": "subscribed", "connectedSince": "1970-01-01T00:00:00.006Z",
       "sessionPresent": true, "unacked": "5", "filtersRefused": "1", "filtersLower": "2",
       "lastError": "keepalive", "lastErrorAt": "1970-01-01T00:00:00.004Z"},
      {"name": "live", "clientId": "", "state": "",
       "sessionPresent": false, "unacked": "0", "filtersRefused": "0", "filtersLower": "0",
       "lastError": ""}]})");
}

TEST(Json, ErrorsAreJsonWhateverBytesTheyRepeat) {
  ExpectSameJson(ErrorJson({"NOT_FOUND", "a \"b\" \\ c\n\xff", "f"}),
                 R"({"error": {"code": "NOT_FOUND", "message": "a \"b\" \\ c\\x0a\\xff",
                     "field": "f"}})");
  ExpectSameJson(ErrorJson({"NOT_FOUND", "m"}),
                 R"({"error": {"code": "NOT_FOUND", "message": "m"}})");
  ExpectSameJson(WordsJson("degraded", {"store", "descriptors"}),
                 R"({"degraded": ["store", "descriptors"]})");
}

// Tests start in the tree's top folder.
TEST(Parts, TheReferenceOfRequestsHasEachOne) {
  std::ifstream file("docs/reference/openapi.yaml");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const std::size_t list = text.find("enum: [", text.find("Which parts each robot carries"));
  ASSERT_NE(list, std::string::npos);
  const std::size_t begin = list + std::string_view("enum: [").size();
  std::string list_text = text.substr(begin, text.find(']', begin) - begin);
  std::ranges::replace(list_text, ',', ' ');
  std::istringstream words(list_text);
  std::size_t found = 0;
  for (std::string word; words >> word; ++found) {
    EXPECT_TRUE(word == "none" || PartFromText(word)) << word;
  }
  EXPECT_EQ(found, kParts + 1) << "each part, and none";
}

}  // namespace
}  // namespace uplink::view
