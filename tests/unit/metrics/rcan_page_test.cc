#include <array>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/rcan/page.h"

namespace uplink::metrics::rcan {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string TextOf(const SeriesPage& page, Format format = Format::kText) {
  std::string text = "what was there before";
  page.Write(format, text);
  return text;
}

SeriesPage Page(std::size_t series_max = 100) { return SeriesPage({.series_max = series_max}); }

TEST(SeriesPage, WritesTheConventionExactly) {
  SeriesPage page = Page();
  page.BeginRobot("rcan://robot.local");
  page.Add(SeriesId::kBatteryPct, 78);
  page.Add(SeriesId::kJointPositionRad, "shoulder_pan", 0.785);
  EXPECT_TRUE(page.EndRobot());
  EXPECT_EQ(TextOf(page),
            "# HELP rcan_acb_position_rad Angle of the joint, radians.\n"
            "# TYPE rcan_acb_position_rad gauge\n"
            "rcan_acb_position_rad{joint=\"shoulder_pan\",ruri=\"rcan://robot.local\"} 0.785\n"
            "# HELP rcan_robot_battery_pct Charge of the battery, percent.\n"
            "# TYPE rcan_robot_battery_pct gauge\n"
            "rcan_robot_battery_pct{ruri=\"rcan://robot.local\"} 78\n");
}

TEST(SeriesPage, SamplesOfASeriesStandTogetherWhicheverRobotsTheyAreOf) {
  SeriesPage page = Page();
  for (const char* ruri : {"rcan://a", "rcan://b"}) {
    page.BeginRobot(ruri);
    page.Add(SeriesId::kOnline, 1);
    page.Add(SeriesId::kBatteryV, 12.5);
    EXPECT_TRUE(page.EndRobot());
  }
  EXPECT_THAT(TextOf(page), HasSubstr("rcan_robot_online{ruri=\"rcan://a\"} 1\n"
                                      "rcan_robot_online{ruri=\"rcan://b\"} 1\n# HELP"));
  EXPECT_EQ(page.samples(), 4U);
}

TEST(SeriesPage, ASeriesMayHaveSeveralLabelsAndANameOfOurs) {
  SeriesPage page = Page();
  page.BeginRobot("a");
  page.Add(SeriesId::kInfo, std::array<std::string_view, 4>{"north", "r17", "5.1", "\""}, 1);
  page.Add(SeriesId::kTop, "bytes", 2.5);
  EXPECT_TRUE(page.EndRobot());
  EXPECT_EQ(page.samples(), 2U);
  EXPECT_THAT(TextOf(page),
              HasSubstr("\nrcan_robot_info{fleet=\"north\",name=\"r17\",software_version=\"5.1\","
                        "agent_version=\"\\\"\",ruri=\"a\"} 1\n"));
  EXPECT_THAT(TextOf(page), HasSubstr("\nuplinkd_top_robots{by=\"bytes\",ruri=\"a\"} 2.5\n"));
}

TEST(SeriesPage, LabelsThatRobotsChooseAreEscaped) {
  SeriesPage page = Page();
  page.BeginRobot("rcan://a\"b\\c\nd");
  page.Add(SeriesId::kExtra, "k\"\\\n", 1);
  EXPECT_TRUE(page.EndRobot());
  EXPECT_THAT(TextOf(page),
              HasSubstr(R"(rcan_robot_extra{key="k\"\\\n",ruri="rcan://a\"b\\c\nd"} 1)"));
}

TEST(SeriesPage, NumbersAreExactAndShort) {
  SeriesPage page = Page();
  page.BeginRobot("r");
  page.Add(SeriesId::kUptimeMs, 3'600'000);
  page.Add(SeriesId::kLatitudeDeg, 0.1 + 0.2);
  page.Add(SeriesId::kSpeedMS, -0.02);
  page.Add(SeriesId::kRangeRemainingM, std::numeric_limits<double>::max());
  page.Add(SeriesId::kLastSignOfLife, 1'763'683'200.125);
  page.Add(SeriesId::kJointErrorFlags, "j", 18446744073709551615.0);
  EXPECT_TRUE(page.EndRobot());
  const std::string text = TextOf(page);
  for (const char* line :
       {"uptime_ms{ruri=\"r\"} 3600000\n", "latitude_deg{ruri=\"r\"} 0.30000000000000004\n",
        "speed_m_s{ruri=\"r\"} -0.02\n", "{ruri=\"r\"} 1.7976931348623157e+308\n",
        "{ruri=\"r\"} 1763683200.125\n", "{joint=\"j\",ruri=\"r\"} 18446744073709551616\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(SeriesPage, ARobotThatDoesNotFitIsLeftOutWhole) {
  SeriesPage page = Page(3);
  page.BeginRobot("a");
  page.Add(SeriesId::kOnline, 1);
  page.Add(SeriesId::kBatteryV, 1);
  EXPECT_TRUE(page.EndRobot());
  page.BeginRobot("b");
  page.Add(SeriesId::kOnline, 1);
  page.Add(SeriesId::kBatteryV, 2);
  EXPECT_FALSE(page.EndRobot());
  EXPECT_EQ(page.samples(), 2U);
  EXPECT_THAT(TextOf(page), Not(HasSubstr("\"b\"")));
  page.BeginRobot("c");
  page.Add(SeriesId::kOnline, 0);
  EXPECT_TRUE(page.EndRobot()) << "at the limit";
  EXPECT_EQ(page.samples(), 3U);
}

TEST(SeriesPage, RoomThatIsHeldCountsAsUsed) {
  SeriesPage page = Page(3);
  page.BeginRobot("a");
  page.Add(SeriesId::kOnline, 1);
  EXPECT_FALSE(page.EndRobot(4));
  page.BeginRobot("a");
  page.Add(SeriesId::kOnline, 1);
  EXPECT_TRUE(page.EndRobot(3));
  page.BeginRobot("b");
  page.Add(SeriesId::kOnline, 1);
  EXPECT_FALSE(page.EndRobot()) << "the room of the one before is full though its samples are not";
}

TEST(SeriesPage, OnlyTheFieldsThatAreAllowedAreWritten) {
  SeriesPage page(
      {.subsystem = "arm2", .fields = {"arm2_effort_nm", "robot_online"}, .series_max = 10});
  page.BeginRobot("a");
  page.Add(SeriesId::kOnline, 1);
  page.Add(SeriesId::kBatteryV, 1);
  page.Add(SeriesId::kJointEffortNm, "j", 2);
  page.Add(SeriesId::kJointPositionM, "j", 2);
  EXPECT_TRUE(page.Writes(SeriesId::kJointEffortNm));
  EXPECT_FALSE(page.Writes(SeriesId::kJointPositionM));
  EXPECT_EQ(page.robot_samples(), 2U);
  EXPECT_TRUE(page.EndRobot());
  EXPECT_THAT(TextOf(page), HasSubstr("rcan_arm2_effort_nm{joint=\"j\",ruri=\"a\"} 2\n"));
  EXPECT_THAT(TextOf(page), Not(HasSubstr("battery_v")));
}

TEST(SeriesPage, IsUsedAgainAndEndsOpenMetricsWithEof) {
  SeriesPage page = Page();
  page.BeginRobot("a");
  page.Add(SeriesId::kOnline, 1);
  EXPECT_TRUE(page.EndRobot());
  page.Clear();
  EXPECT_EQ(TextOf(page), "");
  EXPECT_EQ(TextOf(page, Format::kOpenMetrics), "# EOF\n");
  page.BeginRobot("b");
  page.Add(SeriesId::kOnline, 0);
  EXPECT_TRUE(page.EndRobot());
  EXPECT_THAT(TextOf(page, Format::kOpenMetrics),
              HasSubstr("rcan_robot_online{ruri=\"b\"} 0\n# EOF\n"));
}

TEST(Series, NamesAreUniqueAndSpelledAsPrometheusWants) {
  std::set<std::string> names;
  for (const SeriesSpec& spec : AllSeries()) {
    const std::string name = ShortName(spec, "acb");
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << name;
    EXPECT_TRUE(spec.help.ends_with(".")) << name;
  }
  EXPECT_EQ(JointSeriesOf("position_rad"), 0U);
  EXPECT_EQ(JointSeriesOf("error_flags"), kJointSeries - 1);
  EXPECT_EQ(JointSeriesOf("robot_online"), kSeries);
  EXPECT_THAT(SeriesTable("acb"),
              HasSubstr("| `rcan_robot_info` | `fleet`, `name`, `software_version`"));
  EXPECT_THAT(SeriesTable("acb"), HasSubstr("| `uplinkd_top_robots` | `by`, `ruri` |"));
  EXPECT_THAT(SeriesTable("acb"), HasSubstr("| `rcan_acb_effort_nm` | `joint`, `ruri` |"));
}

}  // namespace
}  // namespace uplink::metrics::rcan
