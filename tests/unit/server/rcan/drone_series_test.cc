#include "server/rcan/drone_series.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::rcan {
namespace {

namespace un = model::uncrew;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kStale{10};

class DroneSeriesTest : public ::testing::Test {
 protected:
  void Hear(const un::Value& value, SteadyTime at = kNow) {
    live_.Apply(
        {.value = value, .metadata = {}, .digest = {}, .received = {}, .received_steady = at});
  }
  [[nodiscard]] std::string Text(bool has_motion = false, SteadyTime now = kNow) {
    metrics::rcan::SeriesPage page({.series_max = 100});
    page.BeginRobot("r");
    if (has_motion) page.Add(metrics::rcan::SeriesId::kLatitudeDeg, 1);
    AddDroneBasic(live_, now, kStale, page);
    NamedSeries series(page, names_, rules_, {.now = now});
    AddDroneNamed(live_, now, kStale, series);
    left_out_ = series.left_out();
    EXPECT_TRUE(page.EndRobot());
    std::string text;
    page.Write(metrics::Format::kText, text);
    return text;
  }

  uncrew::LiveSamples live_;
  const NameRules rules_{
      .hash = NameHash({}),
      .limits = {.names_max = 4, .new_per_hour = 2, .forget_after = std::chrono::minutes(10)}};
  SeriesNames names_;
  SeriesLeftOut left_out_;
};

TEST_F(DroneSeriesTest, TheBatteryOfTheLowestIdIsShown) {
  Hear(un::Battery{.key = 3, .remaining_percent = 30.F});
  Hear(un::Battery{.key = 1, .remaining_percent = 10.F, .battery_function = {}});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 10\n"));
}

TEST_F(DroneSeriesTest, ACurrentIntoTheBatteryChargesIt) {
  EXPECT_THAT(Text(), Not(HasSubstr("charging")));
  Hear(un::Battery{.key = 1, .current_battery_a = 3.F});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_charging{ruri=\"r\"} 0\n"));
  Hear(un::Battery{.key = 1, .current_battery_a = -3.F});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_charging{ruri=\"r\"} 1\n"));
}

TEST_F(DroneSeriesTest, WhatIsStaleHasNoSeries) {
  Hear(un::Heading{.heading_deg = 90}, kNow - kStale);
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_heading_deg{ruri=\"r\"} 90\n"));
  Hear(un::Heading{.heading_deg = 90}, kNow - kStale - milliseconds(1));
  EXPECT_THAT(Text(), Not(HasSubstr("heading")));
}

TEST_F(DroneSeriesTest, WhatItsStreamSaysStandsOnce) {
  Hear(un::Position{.latitude_deg = 2, .longitude_deg = 3});
  const std::string text = Text(true);
  EXPECT_THAT(text, HasSubstr("rcan_robot_latitude_deg{ruri=\"r\"} 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("rcan_robot_latitude_deg{ruri=\"r\"} 2\n")));
  EXPECT_THAT(text, HasSubstr("rcan_robot_longitude_deg{ruri=\"r\"} 3\n"));
}

TEST_F(DroneSeriesTest, SpeedIsOverTheGroundAndClimbIsUpwards) {
  Hear(un::VelocityNed{.north_m_s = 3.F, .east_m_s = 4.F, .down_m_s = -2.F});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_speed_m_s{ruri=\"r\"} 5\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_climb_rate_m_s{ruri=\"r\"} 2\n"));
}

TEST_F(DroneSeriesTest, EachWinchAndSensorHasItsOwn) {
  Hear(un::WinchStatus{.key = 2, .line_length_m = 7.F});
  Hear(un::DistanceSensor{.key = 5, .current_distance_m = 8.F});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_winch_line_m{winch=\"2\",ruri=\"r\"} 7\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_distance_m{sensor=\"5\",ruri=\"r\"} 8\n"));
}

TEST_F(DroneSeriesTest, IdsThatChangeMakeFewNewSeries) {
  SteadyTime now = kNow;
  std::size_t shown = 0;
  for (std::int64_t id = 0; id < 30; ++id) {
    now += std::chrono::minutes(1);
    Hear(un::DistanceSensor{.key = id, .current_distance_m = 8.F}, now);
    const std::string label = "sensor=\"" + std::to_string(id) + "\"";
    const bool is_shown = Text(false, now).find(label) != std::string::npos;
    EXPECT_EQ(is_shown, left_out_.all() == 0) << id;
    shown += is_shown ? 1 : 0;
  }
  EXPECT_EQ(shown, 4U + 2U) << "its first names, and then new_per_hour";
}

}  // namespace
}  // namespace uplink::rcan
