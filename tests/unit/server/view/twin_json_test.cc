// A twin as Robot.cyberwave: the keys, and what may never be among them.
#include "server/view/twin_json.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::view {
namespace {

namespace js = boost::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// The part of that name as text, without the times of arrival.
std::string Part(const test::AppliedTwin& twin, std::string_view name) {
  const js::object all = TwinJson(twin.real());
  const js::value* part = all.if_contains(js::string_view(name.data(), name.size()));
  if (part == nullptr) return "";
  std::string text = js::serialize(*part);
  const std::string arrived = ",\"receivedAt\":\"2025-11-21T00:00:00Z\"";
  for (std::size_t at = text.find(arrived); at != std::string::npos; at = text.find(arrived)) {
    text.erase(at, arrived.size());
  }
  return text;
}

struct PartCase {
  std::string name;
  std::string tail;
  std::string payload;
  std::string part;
};

void PrintTo(const PartCase& each, std::ostream* out) { *out << each.name; }

class TwinJsonPart : public ::testing::TestWithParam<PartCase> {};

TEST_P(TwinJsonPart, IsAsTheVendorNamesIt) {
  const PartCase& each = GetParam();
  test::AppliedTwin twin;
  EXPECT_EQ(Part(twin, each.name), "") << "absent while it was never said";
  (void)twin.Publish(each.tail, each.payload);
  EXPECT_EQ(Part(twin, each.name), each.part);
}

INSTANTIATE_TEST_SUITE_P(
    Parts, TwinJsonPart,
    ::testing::Values(
        PartCase{"position", "position",
                 R"({"source_type":"edge","position":{"x":1,"y":2,"z":3},"timestamp":5.5})",
                 R"({"x":1E0,"y":2E0,"z":3E0,"source_type":"edge","timestamp":5.5E0})"},
        PartCase{"rotation", "rotation", R"({"rotation":{"z":1,"w":0}})",
                 R"({"w":0E0,"x":0E0,"y":0E0,"z":1E0,"source_type":"edge"})"},
        PartCase{"scale", "scale", R"({"source_type":"edit","scale":{"x":1,"y":2,"z":3}})",
                 R"({"x":1E0,"y":2E0,"z":3E0,"source_type":"edit"})"},
        PartCase{"joints", "joint/update", R"({"source_type":"edge_leader","_1":0.5})",
                 R"({"edge_leader":{"_1":{"position":5E-1}}})"},
        PartCase{"metrics", "metrics",
                 R"({"metrics":{"power":{"charging":true,"cells":[1]},"mode":"slow"}})",
                 R"({"mode":"slow","power":{"charging":true,"cells/0":1E0}})"},
        PartCase{"edgeHealth", "edge_health",
                 R"({"edge_id":"e","uptime_seconds":1,"streams":{"front":{"fps":30,)"
                 R"("is_healthy":true,"ice_connection_state":"connected"}},"stream_count":1})",
                 R"({"e":{"uptime_seconds":1E0,"streams":{"front":{"ice_connection_state":)"
                 R"("connected","fps":3E1,"is_healthy":true}},"stream_count":1,)"
                 R"("source_type":"edge"}})"},
        PartCase{"gps", "gps", R"({"latitude":1,"longitude":2,"fix_type":"3d"})",
                 R"({"latitude":1E0,"longitude":2E0,"fix_type":"3d","source_type":"edge"})"},
        PartCase{"battery", "battery/status", R"({"percentage":0.5,"voltage":24})",
                 R"({"percentage":5E-1,"voltage":2.4E1,"source_type":"edge"})"},
        PartCase{"motors", "telemetry", R"({"type":"motor_status","temps":[1]})",
                 R"({"data":{"type":"motor_status","temps":[1]},"source_type":"edge"})"},
        PartCase{"driverInfo", "telemetry", R"({"type":"driver_info","v":"1"})",
                 R"({"data":{"type":"driver_info","v":"1"},"source_type":"edge"})"},
        PartCase{"reports", "telemetry", R"({"telemetry_type":"battery","data":{"level":50}})",
                 R"({"battery":{"data":{"level":5E1},"source_type":"edge"}})"},
        PartCase{"sessions", "telemetry", R"({"type":"telemetry_start","session_id":"s"})",
                 R"({"s":{"connected":true,"telemetry":true,"lastMark":"telemetry_start"}})"},
        PartCase{"lastCommand", "navigate/command",
                 R"({"command":"go","action_id":"a","source_type":"tele","data":{"key":"x"}})",
                 R"({"topic":"twin/navigate/command","command":"go","action_id":"a",)"
                 R"("source_type":"tele"})"},
        PartCase{"media", "depth", "12345", R"({"depth":{"messages":1,"bytes":5}})"},
        PartCase{"observed", "joint/update", R"({"source_type":"tele","_1":1,"_2":1})",
                 R"({"joint/update":1,"setpoints":2})"}),
    [](const auto& each) { return each.param.name; });

TEST(TwinJsonTest, NothingThatWasNeverSaidIsThere) {
  EXPECT_TRUE(TwinJson(test::AppliedTwin().real()).empty());
}

TEST(TwinJsonTest, ASourceThatWeDoNotKnowIsShownAsItCallsItself) {
  test::AppliedTwin twin;
  (void)twin.Publish("joint/update", R"({"source_type":"robotnik","_1":1})");
  EXPECT_EQ(Part(twin, "joints"), R"({"edge":{"_1":{"position":1E0,"source_type":"robotnik"}}})");
}

TEST(TwinJsonTest, NoSecretOfACommandOrOfSignallingIsThere) {
  test::AppliedTwin twin;
  (void)twin.Publish("webrtc-offer", R"({"sdp":"v=0 s3cret","type":"offer"})");
  (void)twin.Publish("webrtc-answer", R"({"sdp":"v=0 s3cret","type":"answer"})");
  (void)twin.Publish("webrtc-candidate", R"({"candidate":"s3cret 1 udp"})");
  (void)twin.Publish("command",
                     R"({"command":"login","data":{"token":"s3cret"},"token":"s3cret"})");
  (void)twin.Publish("depth", R"({"data":"s3cret"})");
  const std::string text = js::serialize(TwinJson(twin.real()));
  EXPECT_THAT(text, Not(HasSubstr("s3cret")));
  EXPECT_THAT(text, HasSubstr(R"("twin/webrtc-offer":1)"));
  EXPECT_THAT(text, HasSubstr("login"));
}

}  // namespace
}  // namespace uplink::view
