#include <cstdint>
#include <limits>
#include <map>
#include <string>

#include <boost/json.hpp>
#include <gtest/gtest.h>

#include "schema/json/geojson.h"
#include "schema/json/render.h"
#include "schema/json/text.h"

namespace uplink::json {
namespace {

boost::json::value Parsed(const std::string& text) { return boost::json::parse(text); }

const model::Positions kOpenRing = {{8.0, 47.0}, {8.5, 47.0}, {8.5, 47.5}};
const model::Positions kClosedRing = {{8.0, 47.0}, {8.5, 47.0}, {8.5, 47.5}, {8.0, 47.0}};

TEST(GeometryText, PutsLongitudeFirst) {
  EXPECT_EQ(Parsed(GeometryText(model::GeoPoint2{8.25, 47.5})),
            Parsed(R"({"type":"Point","coordinates":[8.25,47.5]})"));
}

TEST(GeometryText, NamesEveryGeometryAsTheStandardDoes) {
  EXPECT_EQ(Parsed(GeometryText(model::MultiPoint{{{1, 2}, {3, 4}}})),
            Parsed(R"({"type":"MultiPoint","coordinates":[[1.0,2.0],[3.0,4.0]]})"));
  EXPECT_EQ(Parsed(GeometryText(model::LineString{{{1, 2}, {3, 4}}})),
            Parsed(R"({"type":"LineString","coordinates":[[1.0,2.0],[3.0,4.0]]})"));
  EXPECT_EQ(Parsed(GeometryText(model::MultiLineString{{{{1, 2}, {3, 4}}, {{5, 6}, {7, 8}}}})),
            Parsed(R"({"type":"MultiLineString",
                       "coordinates":[[[1.0,2.0],[3.0,4.0]],[[5.0,6.0],[7.0,8.0]]]})"));
}

TEST(GeometryText, ClosesARingThatWasSentOpenAndSaysSo) {
  const std::string rings = R"("coordinates":[[[8.0,47.0],[8.5,47.0],[8.5,47.5],[8.0,47.0]]])";
  EXPECT_EQ(Parsed(GeometryText(model::PolygonData{kOpenRing, {}})),
            Parsed(R"({"type":"Polygon","openRings":[0],)" + rings + "}"));
  EXPECT_EQ(Parsed(GeometryText(model::PolygonData{kClosedRing, {}})),
            Parsed(R"({"type":"Polygon",)" + rings + "}"));
}

TEST(GeometryText, ClosesHolesAndThePartsOfAMultiPolygon) {
  const model::PolygonData mixed{kClosedRing, {kOpenRing}};
  const model::PolygonData open{kOpenRing, {kOpenRing}};
  const model::PolygonData closed{kClosedRing, {kClosedRing}};
  const auto geometry = RenderGeometry(model::MultiPolygon{{mixed, closed, open}});
  EXPECT_EQ(geometry.at("coordinates"),
            RenderGeometry(model::MultiPolygon{{closed, closed, closed}}).at("coordinates"));
  EXPECT_EQ(geometry.at("coordinates").as_array().size(), 3U);
  EXPECT_EQ(geometry.at("openRings"), boost::json::value({1, 4, 5}));
}

TEST(DetailTextTest, IsEmptyForVoidMembersAndNamesTheFieldsOfOthers) {
  EXPECT_EQ(DetailText(model::EstopEngagedEvent{}), "{}");
  EXPECT_EQ(DetailText(model::ModeChangedEvent{model::RobotMode::kAuto, model::RobotMode::kTeleop}),
            R"({"from":"auto","to":"teleop"})");
}

TEST(DetailTextTest, OfANamedEventIsItsDetailAsItStands) {
  const model::NamedEvent event{"cyberwave/bumped", R"({ "b":1.0E0, "a":null })"};
  EXPECT_EQ(DetailText(event), event.detail_json);
  EXPECT_EQ(model::EventKindText(event), "cyberwave/bumped");
  const model::EventTelemetry whole{.unix_time_ms = 5, .kind = event};
  EXPECT_EQ(boost::json::serialize(Render(whole)),
            R"({"unixTimeMs":5,"kind":{"cyberwave/bumped":{"b":1E0,"a":null}}})");
  EXPECT_TRUE(RenderDetail(model::NamedEvent{"k", "no object"}).empty());
}

TEST(TextTest, LeavesAbsentOptionalsOut) {
  model::AgentInfo info{.agent_version = "1.2"};
  EXPECT_EQ(Text(info), R"({"agentVersion":"1.2"})");
  info.os_info = "Debian";
  info.uptime_s = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(Text(info),
            R"({"agentVersion":"1.2","osInfo":"Debian","uptimeS":18446744073709551615})");
}

TEST(TextTest, ShowsSettingsByKeyWithBareValues) {
  const model::CurrentSettings settings{{{"speed", model::Value(1.75)},
                                         {"passes", model::Value(std::int32_t{-4})},
                                         {"lights", model::Value(false)},
                                         {"name", model::Value(std::string("Öl"))},
                                         {"gear", model::Value(model::EnumName{"high"})}}};
  EXPECT_EQ(Parsed(Text(settings)),
            Parsed(R"({"speed":1.75,"passes":-4,"lights":false,"name":"Öl","gear":"high"})"));
}

TEST(TextTest, EscapesWhatJsonReserves) {
  model::MissionRunStatus report;
  report.run_id = "a\"b\\c\n\x01\xF0\x9F\xA6\x8A";
  EXPECT_EQ(Parsed(Text(report)).at("runId").as_string(), report.run_id);
}

TEST(TextTest, KeepsEveryBitOfANumber) {
  model::Pose pose{.lat_deg = 47.123456789012345, .lon_deg = -0.1};
  const boost::json::value parsed = Parsed(Text(pose));
  EXPECT_EQ(parsed.at("latDeg").as_double(), pose.lat_deg);
  EXPECT_EQ(parsed.at("lonDeg").as_double(), pose.lon_deg);
  EXPECT_EQ(parsed.as_object().count("headingDeg"), 0U);
}

TEST(TextTest, AnArrayKeepsEachTextAsItIs) {
  const std::vector<std::string> texts = {"", "a\"b\\c\n", "\u00e4"};
  EXPECT_EQ(ArrayText(texts), "[\"\",\"a\\\"b\\\\c\\n\",\"\u00e4\"]");
  EXPECT_EQ(ArrayText({}), "[]");
}

TEST(JsonText, TextsByNameComeBackAsTheyWere) {
  const std::map<std::string, std::string> texts = {{"", "a\"b\\c\n"}, {"\u00e4", ""}};
  EXPECT_EQ(TextsIn(TextsText(texts)), texts);
  EXPECT_EQ(TextsText({}), "{}");
  EXPECT_EQ(TextsIn(R"({"a": "1", "b": 2})"), (std::map<std::string, std::string>{{"a", "1"}}));
  for (const char* const other : {"", "[]", "{", "null"}) EXPECT_TRUE(TextsIn(other).empty());
}

}  // namespace
}  // namespace uplink::json
