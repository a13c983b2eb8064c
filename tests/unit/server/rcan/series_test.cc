// What the series of one robot say, by what is known of it.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/judge.h"
#include "server/rcan/robot_series.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::rcan {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::Not;

class SeriesTest : public ::testing::Test {
 protected:
  void Apply(const model::Body& body) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(body));
    state_.Apply(records, clock_.Steady());
  }
  void Apply(model::RcanState state) { state_.Apply(std::move(state), clock_.Steady()); }
  void Hear() { state_.SignOfLife(clock_.Steady(), clock_.System(), limits_); }
  void Sweep() { state_.Sweep(clock_.Steady(), clock_.System(), limits_); }
  std::string Text() {
    metrics::rcan::SeriesPage page({.series_max = 1000});
    page.BeginRobot("r");
    SeriesNames names;
    const NameRules rules{NameHash({}), {.names_max = robot_series_max_, .new_per_hour = 1}};
    NamedSeries series(page, names, rules, {.now = clock_.Steady()});
    state_.LookAt([&](const robot::StateView& view) {
      const Shown shown = AddBasic("r", view,
                                   {.now = clock_.System(),
                                    .steady_now = clock_.Steady(),
                                    .series_ttl = seconds(600),
                                    .presence_timeout = limits_.timeout,
                                    .faults = faults_},
                                   page);
      AddNamed(view, shown, extras_, series);
    });
    EXPECT_TRUE(page.EndRobot());
    std::string text;
    page.Write(metrics::Format::kText, text);
    return text;
  }

  testing::ManualClock clock_;
  robot::PresenceLimits limits_;
  robot::RobotState state_{clock_.Steady(), clock_.Steady(), clock_.System()};
  std::vector<std::string> extras_;
  const view::FaultCounts::Map* faults_ = nullptr;
  std::size_t robot_series_max_ = 1000;
};

model::StatusTelemetry Status(float volts, float percent) {
  model::StatusTelemetry status;
  status.battery = model::BatteryStatus{.soc_pct = percent, .voltage_v = volts, .temperature = 20};
  return status;
}

model::TelemetryExtras Reading(const std::string& key, const model::Value& value) {
  model::TelemetryExtras extras;
  extras.kv.push_back({.key = key, .value = value, .unix_time_ms = {}});
  return extras;
}

model::RcanState WithJoint(const std::string& name, double position) {
  model::RcanState state;
  state.joints.push_back({.joint = name, .position_rad = position, .timestamp_us = 1});
  return state;
}

TEST_F(SeriesTest, ARobotThatWasNeverHeardHasNoSeries) { EXPECT_EQ(Text(), ""); }

TEST_F(SeriesTest, PresenceStaysAndValuesVanishAfterTheirTime) {
  Hear();
  Apply(Status(12.5, 50));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 1\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 12.5\n"));
  const double heard = static_cast<double>(UnixMs(clock_.System())) / 1000;
  clock_.Advance(seconds(11));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 0\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v"));
  clock_.Advance(seconds(599));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v")) << "at the limit";
  clock_.Advance(seconds(1));
  EXPECT_THAT(Text(), Not(HasSubstr("battery")));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 0\n"));
  EXPECT_THAT(Text(), HasSubstr("last_sign_of_life_timestamp_seconds{ruri=\"r\"} " +
                                std::to_string(static_cast<std::int64_t>(heard))));
}

TEST_F(SeriesTest, ValuesStayWhileItsOwnStreamIsHeldBack) {
  Hear();
  Apply(Status(12.5, 50));
  state_.SetReading(robot::RobotState::Reading::kHeldBack, clock_.Steady());
  clock_.Advance(seconds(3600));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v"));
  state_.SetReading(robot::RobotState::Reading::kFlowing, clock_.Steady());
  clock_.Advance(seconds(610));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v")) << "at the limit, after it went offline";
  clock_.Advance(seconds(1));
  EXPECT_THAT(Text(), Not(HasSubstr("battery")));
}

TEST_F(SeriesTest, AStallOfTheServerBringsNobodyBack) {
  Hear();
  Apply(Status(12.5, 50));
  clock_.Advance(seconds(7200));
  Sweep();
  EXPECT_THAT(Text(), Not(HasSubstr("battery")));
  state_.NoteStall(clock_.Steady());
  EXPECT_THAT(Text(), Not(HasSubstr("battery")));
}

TEST_F(SeriesTest, StatesThatAreNoSignOfLifeAreShownWhileTheyCome) {
  Apply(Status(12.5, 50));
  Hear();
  clock_.Advance(seconds(7200));
  model::RcanState state = WithJoint("a", 1);
  state.battery_v = 24;
  Apply(std::move(state));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("position_rad{joint=\"a\""));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 24\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("battery_pct"))) << "two hours old";
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 0\n"));
  clock_.Advance(seconds(611));
  EXPECT_THAT(Text(), Not(HasSubstr("position_rad")));
}

TEST_F(SeriesTest, ARobotThatAnotherServerHoldsHasItsSeriesThere) {
  Hear();
  state_.Lose();
  EXPECT_EQ(Text(), "");
}

TEST_F(SeriesTest, AfterARestartPresenceIsNotSaidBeforeItIsKnown) {
  robot::LiveBefore before;
  before.last_sign_of_life = clock_.System() - seconds(30);
  before.parts.status = Status(12.5, 50);
  state_.Restore(std::move(before), 0);
  EXPECT_THAT(Text(), Not(HasSubstr("rcan_robot_online{")));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 12.5\n"));
  clock_.Advance(seconds(130));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 0\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_battery_v{ruri=\"r\"} 12.5\n"));
  clock_.Advance(seconds(451));
  EXPECT_THAT(Text(), Not(HasSubstr("battery"))) << "too long ago";
}

TEST_F(SeriesTest, ARestartShowsNoValuesOfARobotThatWasLongGone) {
  robot::LiveBefore before;
  before.last_sign_of_life = clock_.System() - seconds(86'400);
  before.parts.status = Status(12.5, 50);
  state_.Restore(std::move(before), 0);
  EXPECT_THAT(Text(), Not(HasSubstr("battery")));
  clock_.Advance(seconds(130));
  Sweep();
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"r\"} 0\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("battery"))) << "offline since now, but silent for a day";
}

TEST_F(SeriesTest, OfMotionAndStatusEverythingKnownIsSaidAndNothingElse) {
  Hear();
  model::MotionTelemetry motion;
  motion.pose = model::Pose{.lat_deg = 47.25, .lon_deg = 8.5, .altitude_m = 410};
  motion.velocity = model::VelTwist{.linear_mps = 1.5F};
  Apply(motion);
  model::StatusTelemetry status = Status(12.5, 50);
  status.faulted = true;
  status.mission_active = true;
  status.estop = model::EStop{.active = true};
  status.fuel = model::FuelStatus{.level_pct = 60};
  status.range_remaining = 1200;
  Apply(status);
  const std::string text = Text();
  for (const char* line :
       {"latitude_deg{ruri=\"r\"} 47.25", "longitude_deg{ruri=\"r\"} 8.5",
        "altitude_m{ruri=\"r\"} 410", "speed_m_s{ruri=\"r\"} 1.5", "faulted{ruri=\"r\"} 1",
        "accepting_missions{ruri=\"r\"} 1", "estop{ruri=\"r\"} 1", "fuel_pct{ruri=\"r\"} 60",
        "range_remaining_m{ruri=\"r\"} 1200", "battery_temperature_c{ruri=\"r\"} 20",
        "battery_pct{ruri=\"r\"} 50"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  for (const char* absent : {"heading_deg", "turn_rate", "runtime_remaining", "uptime_ms"}) {
    EXPECT_THAT(text, Not(HasSubstr(absent)));
  }
}

TEST_F(SeriesTest, TheFresherOfStatusAndRobotStateIsShown) {
  Hear();
  Apply(Status(11, 11));
  model::RcanState rcan;
  rcan.battery_v = 22;
  Apply(rcan);
  EXPECT_THAT(Text(), HasSubstr("battery_v{ruri=\"r\"} 22\n")) << "both at once";
  EXPECT_THAT(Text(), HasSubstr("battery_pct{ruri=\"r\"} 11\n")) << "the one that says it";
  clock_.Advance(seconds(1));
  Apply(Status(33, 33));
  EXPECT_THAT(Text(), HasSubstr("battery_v{ruri=\"r\"} 33\n"));
}

TEST_F(SeriesTest, RobotStatesGiveTheirOwnFieldsAndJoints) {
  Hear();
  model::RcanState state = WithJoint("shoulder_pan", 0.785);
  state.uptime_ms = 3'600'000;
  state.position = model::RcanPosition{.x_m = 1.5, .y_m = -2};
  state.joints.front().error_flags = 3;
  Apply(state);
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_rad{joint=\"shoulder_pan\",ruri=\"r\"} 0.785\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_error_flags{joint=\"shoulder_pan\",ruri=\"r\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_uptime_ms{ruri=\"r\"} 3600000\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_position_x_m{ruri=\"r\"} 1.5\n"));
  EXPECT_THAT(text, Not(HasSubstr("heading")));
}

TEST_F(SeriesTest, JointsOfExtrasStandBesideAndGiveWayToWhatIsFresher) {
  Hear();
  Apply(Reading("joint/pan/position_rad", 1.0));
  Apply(Reading("joint/a/b/effort_nm", std::int32_t{5}));
  for (const char* none : {"joint/pan/colour", "joint/pan", "joint//position_rad", "joint/x/",
                           "joints/pan/position_rad"}) {
    Apply(Reading(none, 7.0));
  }
  Apply(Reading("joint/pan/velocity_rad_s", std::string("fast")));
  EXPECT_THAT(Text(), HasSubstr("rcan_acb_position_rad{joint=\"pan\",ruri=\"r\"} 1\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_acb_effort_nm{joint=\"a/b\",ruri=\"r\"} 5\n"));
  EXPECT_THAT(Text(), Not(HasSubstr(" 7\n")));
  clock_.Advance(seconds(1));
  Apply(WithJoint("pan", 2));
  EXPECT_THAT(Text(), HasSubstr("position_rad{joint=\"pan\",ruri=\"r\"} 2\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("position_rad{joint=\"pan\",ruri=\"r\"} 1\n")))
      << "a series stands once";
  EXPECT_THAT(Text(), HasSubstr("effort_nm{joint=\"a/b\",ruri=\"r\"} 5\n"));
  clock_.Advance(seconds(1));
  Apply(Reading("joint/pan/position_rad", 3.0));
  EXPECT_THAT(Text(), HasSubstr("position_rad{joint=\"pan\",ruri=\"r\"} 3\n"));
}

TEST_F(SeriesTest, ExtrasAreShownByTheirListAlone) {
  Hear();
  Apply(Reading("rpm", std::int32_t{3120}));
  Apply(Reading("ok", true));
  Apply(Reading("note", std::string("fine")));
  EXPECT_THAT(Text(), Not(HasSubstr("rcan_robot_extra")));
  extras_ = {"rpm", "ok", "note", "none"};
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_extra{key=\"rpm\",ruri=\"r\"} 3120\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_extra{key=\"ok\",ruri=\"r\"} 1\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("key=\"no")));
}

TEST_F(SeriesTest, ReportsGiveBootProgressAndHealth) {
  Hear();
  model::AgentInfo info;
  info.uptime_s = 60;
  state_.KeepReport(info, FromUnixMs(1'763'683'200'000));
  const auto report = [this](const std::string& run, std::uint16_t progress,
                             model::MissionStatus status) {
    model::MissionRunStatus body;
    body.run_id = run;
    body.progress_x100 = progress;
    body.status = status;
    state_.KeepReport(body, clock_.System());
  };
  report("one", 1000, model::MissionStatus::kRunning);
  report("two", 2550, model::MissionStatus::kRunning);
  model::SystemHealth health;
  health.device_id = "cpu1";
  health.cpu_pct = 10;
  Apply(health);
  EXPECT_THAT(Text(), HasSubstr("booted_timestamp_seconds{ruri=\"r\"} 1763683140\n"));
  EXPECT_THAT(Text(), HasSubstr("mission_progress_pct{ruri=\"r\"} 25.5\n"));
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_cpu_pct{device=\"cpu1\",ruri=\"r\"} 10\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("mem_pct")));
  report("two", 10'000, model::MissionStatus::kComplete);
  EXPECT_THAT(Text(), HasSubstr("mission_progress_pct{ruri=\"r\"} 10\n")) << "the one that is open";
  report("one", 1000, model::MissionStatus::kAborted);
  EXPECT_THAT(Text(), Not(HasSubstr("mission_progress")));
}

TEST_F(SeriesTest, ActiveFaultsAreZeroWhereThereAreNoneAndAbsentWhereNobodyKnows) {
  Hear();
  EXPECT_THAT(Text(), Not(HasSubstr("active_faults")));
  view::FaultCounts::Map faults;
  faults_ = &faults;
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_active_faults{severity=\"critical\",ruri=\"r\"} 0\n"));
  EXPECT_THAT(Text(), Not(HasSubstr("unrecognized")));
  faults["r"] = {0, 2, 0, 1, 4};
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_active_faults{severity=\"minor\",ruri=\"r\"} 2\n"));
  EXPECT_THAT(Text(), HasSubstr("{severity=\"unrecognized\",ruri=\"r\"} 4\n"));
}

TEST_F(SeriesTest, ABatteryChargesOrNotIfTheRobotSaysWhich) {
  Hear();
  model::StatusTelemetry status = Status(12.5, 50);
  Apply(status);
  EXPECT_THAT(Text(), Not(HasSubstr("charging")));
  using Supply = model::PowerSupplyStatus;
  for (const auto& [supply, shown] :
       {std::pair{Supply::kCharging, "1"}, std::pair{Supply::kDischarging, "0"},
        std::pair{Supply::kNotCharging, "0"}, std::pair{Supply::kFull, "0"}}) {
    status.battery->power_supply_status = supply;
    Apply(status);
    EXPECT_THAT(Text(), HasSubstr(std::string("battery_charging{ruri=\"r\"} ") + shown + "\n"));
  }
}

TEST_F(SeriesTest, AMissionThatFailedHasTheTimeOfItsReport) {
  Hear();
  model::MissionRunStatus run;
  run.run_id = "one";
  for (const auto status : {model::MissionStatus::kComplete, model::MissionStatus::kAborted}) {
    run.status = status;
    state_.KeepReport(run, clock_.System());
  }
  EXPECT_THAT(Text(), Not(HasSubstr("mission_failed")));
  run.status = model::MissionStatus::kError;
  state_.KeepReport(run, FromUnixMs(1'763'683'200'000));
  EXPECT_THAT(Text(), HasSubstr("mission_failed_timestamp_seconds{ruri=\"r\"} 1763683200\n"));
}

/// Everything that a robot can say without a word of its own.
model::StatusTelemetry FullStatus() {
  model::StatusTelemetry status = Status(12.5, 50);
  status.battery->power_supply_status = model::PowerSupplyStatus::kCharging;
  status.estop = model::EStop{.active = true};
  status.fuel = model::FuelStatus{.level_pct = 60};
  status.range_remaining = 1200;
  status.runtime_remaining = 60;
  return status;
}

TEST_F(SeriesTest, WhatHasNoWordOfTheRobotsHasItsPlaceWhateverElseItSays) {
  Hear();
  model::RcanState state;
  for (int i = 0; i < 100; ++i) {
    state.joints.push_back(
        {.joint = "j" + std::to_string(i), .position_rad = 1, .timestamp_us = 1});
  }
  state.uptime_ms = 1;
  state.position = model::RcanPosition{.x_m = 1.5, .y_m = -2, .heading_rad = 1};
  Apply(state);
  Apply(FullStatus());
  model::MotionTelemetry motion;
  motion.pose = model::Pose{.lat_deg = 1, .lon_deg = 2, .altitude_m = 3, .heading_deg = 4};
  motion.velocity = model::VelTwist{.linear_mps = 1, .angular_rps = 2};
  Apply(motion);
  model::AgentInfo info;
  info.uptime_s = 60;
  state_.KeepReport(info, clock_.System());
  model::MissionRunStatus run;
  run.run_id = "one";
  run.progress_x100 = 1;
  run.status = model::MissionStatus::kRunning;
  state_.KeepReport(run, clock_.System());
  run.run_id = "two";
  run.status = model::MissionStatus::kError;
  state_.KeepReport(run, clock_.System());
  view::FaultCounts::Map faults;
  faults["r"] = {0, 2, 0, 1, 4};
  faults_ = &faults;
  // The smallest that rcan.robot_series_max can be.
  robot_series_max_ = 64;
  const std::string text = Text();
  std::size_t without = 0;
  for (const metrics::rcan::SeriesSpec& spec : metrics::rcan::AllSeries()) {
    if (!spec.label.empty() && spec.label != "severity") continue;
    if (spec.id == metrics::rcan::SeriesId::kPositionZM) continue;  // twins alone say it
    if (spec.source.starts_with("drone ")) continue;                // drones alone say it
    EXPECT_THAT(text, HasSubstr("\nrcan_" + std::string(spec.name) + "{")) << spec.name;
    ++without;
  }
  const std::size_t severities = model::kEnumNames<model::FaultSeverity>.size() + 1;
  const auto joints = static_cast<std::size_t>(64 - (without - 1) - severities);
  EXPECT_THAT(text, HasSubstr("{joint=\"j" + std::to_string(joints - 1) + "\""));
  EXPECT_THAT(text, Not(HasSubstr("{joint=\"j" + std::to_string(joints) + "\"")));
}

TEST_F(SeriesTest, ExtrasThatTheOperatorAskedForComeBeforeComputersAndTheseBeforeJoints) {
  Hear();
  Apply(WithJoint("a", 1));
  Apply(Reading("rpm", std::int32_t{3120}));
  model::SystemHealth health;
  health.device_id = "cpu1";
  health.cpu_pct = 10;
  health.mem_pct = 20;
  Apply(health);
  extras_ = {"rpm"};
  robot_series_max_ = 2 + 1;
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_extra{"));
  EXPECT_THAT(Text(), Not(HasSubstr("device=")));
  robot_series_max_ = 2 + 1 + 2;
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_mem_pct{device=\"cpu1\""));
  EXPECT_THAT(Text(), Not(HasSubstr("joint=")));
  robot_series_max_ = 2 + 1 + 2 + 1;
  EXPECT_THAT(Text(), HasSubstr("joint=\"a\""));
}

}  // namespace
}  // namespace uplink::rcan
