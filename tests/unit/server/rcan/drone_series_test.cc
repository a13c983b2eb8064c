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
  [[nodiscard]] std::string Text(bool has_motion = false) {
    metrics::rcan::SeriesPage page({.series_max = 100});
    page.BeginRobot("r");
    if (has_motion) page.Add(metrics::rcan::SeriesId::kLatitudeDeg, 1);
    AddDrone(live_, kNow, kStale, page);
    EXPECT_TRUE(page.EndRobot());
    std::string text;
    page.Write(metrics::Format::kText, text);
    return text;
  }

  uncrew::LiveSamples live_;
};

TEST_F(DroneSeriesTest, TheBatteryOfTheLowestIdIsShown) {
  Hear(un::Battery{.key = 3, .remaining_percent = 30.F});
  Hear(un::Battery{.key = 1, .remaining_percent = 10.F, .battery_function = {}});
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_pct{ruri=\"r\"} 10\n"));
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

}  // namespace
}  // namespace uplink::rcan
