// What the series of a twin say.
#include "server/rcan/twin_series.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::rcan {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class TwinSeriesTest : public ::testing::Test {
 protected:
  void Publish(std::string_view tail, std::string_view payload) {
    EXPECT_NE(twin_.Say(tail, payload), cyberwave::Outcome::kIgnored) << payload;
    twin_.clock.Advance(milliseconds(1));
  }
  std::string Text(const cyberwave::TwinParts& parts) {
    metrics::rcan::SeriesPage page({.series_max = 10'000});
    page.BeginRobot("r");
    SeriesNames names;
    const NameRules rules{NameHash({}), {.names_max = series_max_, .new_per_hour = 1}};
    NamedSeries series(page, names, rules, {.now = twin_.clock.Steady()});
    AddTwinBasic(parts, page);
    AddTwinNamed(parts, series);
    left_out_ = series.left_out().all();
    EXPECT_TRUE(page.EndRobot());
    std::string text;
    page.Write(metrics::Format::kText, text);
    return text;
  }
  std::string Text() { return Text(twin_.real()); }

  test::AppliedTwin twin_;
  std::size_t series_max_ = 1'000;
  std::size_t left_out_ = 0;
};

TEST_F(TwinSeriesTest, ATwinThatSaidNothingHasNone) { EXPECT_EQ(Text(), ""); }

TEST_F(TwinSeriesTest, PlaceAndHeadingAreOfPositionRotationAndGps) {
  Publish("position", R"({"position":{"x":1,"y":-2,"z":3.5}})");
  Publish("rotation", R"({"rotation":{"w":0,"x":0,"y":0,"z":5}})");
  Publish("gps", R"({"latitude":47.5,"longitude":8.25,"altitude":410,"compass_heading":-90})");
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_robot_position_x_m{ruri=\"r\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_position_y_m{ruri=\"r\"} -2\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_position_z_m{ruri=\"r\"} 3.5\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_position_heading_rad{ruri=\"r\"} 3.14159"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_latitude_deg{ruri=\"r\"} 47.5\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_longitude_deg{ruri=\"r\"} 8.25\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_altitude_m{ruri=\"r\"} 410\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_heading_deg{ruri=\"r\"} 270\n"));
}

TEST_F(TwinSeriesTest, AHeadingNeedsNoUnitQuaternion) {
  const double half = std::sqrt(0.5);
  EXPECT_DOUBLE_EQ(HeadingOf({}), 0);
  EXPECT_DOUBLE_EQ(HeadingOf({.w = half, .z = half}), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(HeadingOf({.w = 7, .z = -7}), -std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(HeadingOf({.w = 1e300, .z = 1e300}), std::numbers::pi / 2);
  EXPECT_NEAR(HeadingOf({.w = half, .x = half}), 0, 1e-12) << "rolled, not turned";
  EXPECT_DOUBLE_EQ(HeadingOf({.w = 5e-324, .z = 5e-324}), std::numbers::pi / 2);
}

TEST_F(TwinSeriesTest, JointsAreOfEdgeAndFollowerInTheirUnits) {
  twin_.terms.prismatic_joints = {"slide"};
  Publish("joint/update", R"({"positions":{"a":1,"slide":2},"velocities":{"a":3,"slide":4},)"
                          R"("efforts":{"a":5,"slide":6}})");
  Publish("joint/update", R"({"source_type":"edge_follower","positions":{"b":7}})");
  Publish("joint/update", R"({"source_type":"edge_leader","positions":{"a":99,"c":98}})");
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_rad{joint=\"a\",ruri=\"r\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_velocity_rad_s{joint=\"a\",ruri=\"r\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_effort_nm{joint=\"a\",ruri=\"r\"} 5\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_m{joint=\"slide\",ruri=\"r\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_velocity_m_s{joint=\"slide\",ruri=\"r\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_effort_nm{joint=\"slide\",ruri=\"r\"} 6\n"));
  EXPECT_THAT(text, Not(HasSubstr("position_rad{joint=\"slide\"")));
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_rad{joint=\"b\",ruri=\"r\"} 7\n"));
  EXPECT_THAT(text, Not(HasSubstr("99")));
  EXPECT_THAT(text, Not(HasSubstr("98")));
}

TEST_F(TwinSeriesTest, AJointThatEdgeAndFollowerSayHasOneSample) {
  Publish("joint/update", R"({"positions":{"a":1},"velocities":{"a":2}})");
  Publish("joint/update",
          R"({"source_type":"edge_follower","positions":{"a":3},"efforts":{"a":4}})");
  std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_rad{joint=\"a\",ruri=\"r\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_velocity_rad_s{joint=\"a\",ruri=\"r\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_effort_nm{joint=\"a\",ruri=\"r\"} 4\n"));
  EXPECT_EQ(text.find("position_rad{"), text.rfind("position_rad{")) << text;
  Publish("joint/update", R"({"positions":{"a":5}})");
  EXPECT_THAT(Text(), HasSubstr("rcan_acb_position_rad{joint=\"a\",ruri=\"r\"} 5\n"));
}

TEST_F(TwinSeriesTest, ASimulationHasNoJointsHere) {
  Publish("joint/update", R"({"source_type":"sim","_1":1})");
  Publish("position", R"({"source_type":"sim","position":{"x":1,"y":2,"z":3}})");
  EXPECT_THAT(Text(twin_.sim()), Not(HasSubstr("joint")));
  EXPECT_THAT(Text(twin_.sim()), HasSubstr("position_x_m"));
}

TEST_F(TwinSeriesTest, ABatteryChargesAsTheLastOfTwoSourcesSays) {
  EXPECT_THAT(Text(), Not(HasSubstr("charging")));
  Publish("battery/status", R"({"percentage":50,"charging":true})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_charging{ruri=\"r\"} 1\n"));
  Publish("telemetry", R"({"telemetry_type":"battery","data":{"level":70,"charging":false}})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_charging{ruri=\"r\"} 0\n"));
}

TEST_F(TwinSeriesTest, ABatteryOfUpToOneIsShownByNoSeries) {
  Publish("battery/status", R"({"percentage":1,"voltage":24})");
  EXPECT_THAT(Text(), Not(HasSubstr("battery_pct")));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 24\n"));
  Publish("battery/status", R"({"percentage":1.01})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 1.01\n"));
  Publish("battery/status", R"({"percentage":0})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 0\n"));
}

TEST_F(TwinSeriesTest, TheBatteryIsWhatArrivedLast) {
  Publish("metrics", R"({"metrics":{"power":{"battery_percent":50,"voltage":20,)"
                     R"("estimated_runtime_minutes":2.5}}})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 50\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 20\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_runtime_remaining_s{ruri=\"r\"} 150\n"));
  Publish("battery/status", R"({"percentage":60})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 60\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 20\n")) << "still there";
  Publish("telemetry", R"({"telemetry_type":"battery","data":{"level":70}})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 70\n"));
  Publish("battery/status", R"({"percentage":0.8})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 70\n"))
      << "an unclear value replaces nothing";
}

TEST_F(TwinSeriesTest, AnEdgeIsADevice) {
  Publish("edge_health", R"({"edge_id":"pi","uptime_seconds":10,"streams":{},"stream_count":3,)"
                         R"("healthy_streams":2,"host_memory_percent":40,"host_cpu_percent":30,)"
                         R"("host_disk_percent":20,"cpu_temp_c":61.5})");
  std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_robot_cpu_pct{device=\"pi\",ruri=\"r\"} 30\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_mem_pct{device=\"pi\",ruri=\"r\"} 40\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_disk_pct{device=\"pi\",ruri=\"r\"} 20\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_cpu_temperature_c{device=\"pi\",ruri=\"r\"} 61.5\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_streams{device=\"pi\",ruri=\"r\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_streams_healthy{device=\"pi\",ruri=\"r\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_uptime_ms{ruri=\"r\"} 10000\n"));
  Publish("edge_health", R"({"uptime_seconds":5})");
  Publish("edge_health", R"({"edge_id":"pi","uptime_seconds":11})");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_uptime_ms{ruri=\"r\"} 5000\n"))
      << "of the twin's own driver";
}

TEST_F(TwinSeriesTest, OtherMetricsAreExtras) {
  Publish("metrics", R"({"metrics":{"power":{"battery_percent":50,"charging":true},)"
                     R"("load":{"cpu":{"user":1.5}},"temperature":30,"mode":"slow"}})");
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_robot_extra{key=\"metrics/power/charging\",ruri=\"r\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_extra{key=\"metrics/load/cpu/user\",ruri=\"r\"} 1.5\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_extra{key=\"metrics/temperature\",ruri=\"r\"} 30\n"));
  EXPECT_THAT(text, Not(HasSubstr("metrics/power/battery_percent")));
  EXPECT_THAT(text, Not(HasSubstr("mode")));
}

TEST_F(TwinSeriesTest, ManyMetricsTakeNoPlaceOfJoints) {
  series_max_ = 10;
  std::string metrics = R"("m0":0)";
  for (int i = 1; i < 50; ++i) metrics += ",\"m" + std::to_string(i) + "\":1";
  Publish("metrics", R"({"metrics":{"all":{)" + metrics + "}}}");
  Publish("joint/update", R"({"positions":{"a":1},"velocities":{"a":3}})");
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("position_rad{joint=\"a\""));
  EXPECT_THAT(text, HasSubstr("velocity_rad_s{joint=\"a\""));
  EXPECT_EQ(left_out_, 42U);
}

TEST_F(TwinSeriesTest, ANumberBeyondADoubleIsNoSample) {
  Publish("metrics", R"({"metrics":{"power":{"estimated_runtime_minutes":1e308}}})");
  Publish("edge_health", R"({"uptime_seconds":1e308})");
  EXPECT_THAT(Text(), Not(HasSubstr("runtime")));
  EXPECT_THAT(Text(), Not(HasSubstr("uptime")));
}

}  // namespace
}  // namespace uplink::rcan
