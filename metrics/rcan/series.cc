#include "metrics/rcan/series.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

namespace uplink::metrics::rcan {
namespace {

using enum SeriesId;

constexpr std::string_view kJoint = "joint";
constexpr std::string_view kDevice = "device";
/// How the names of our own series begin.
constexpr std::string_view kOurs = "uplinkd_";
constexpr std::string_view kFromJoints =
    "Robot State, `joints`; extras `joint/NAME/...`; twin joints of `edge`, `edge_follower`";

constexpr auto kSpecs = std::to_array<SeriesSpec>({
    {kJointPositionRad, "position_rad", kJoint, "Angle of the joint, radians.", kFromJoints},
    {kJointVelocityRadS, "velocity_rad_s", kJoint, "Velocity of the joint, radians a second.",
     kFromJoints},
    {kJointPositionM, "position_m", kJoint, "Position of the prismatic joint, metres.",
     kFromJoints},
    {kJointVelocityMS, "velocity_m_s", kJoint, "Velocity of the prismatic joint, metres a second.",
     kFromJoints},
    {kJointEffortNm, "effort_nm", kJoint,
     "Torque of the joint, newton metres; of a prismatic joint its force.", kFromJoints},
    {kJointTemperatureC, "temperature_c", kJoint,
     "Temperature of the joint's motor or actuator, degrees Celsius.", kFromJoints},
    {kJointErrorFlags, "error_flags", kJoint,
     "Error bits of the joint, the vendor's; bits above 2^53 blur.", kFromJoints},
    {kInfo, "robot_info", "fleet,name,software_version,agent_version",
     "1; its fleet, the last segment of its RURI, and what it runs.",
     "agentInfo `softwareVersion`, `agentVersion`; Hello `agent_version`"},
    {kOnline, "robot_online", "", "1 if the robot is online, 0 if it is offline.", "presence"},
    {kLastSignOfLife, "robot_last_sign_of_life_timestamp_seconds", "",
     "Unix time at which the robot was last heard, by the server's clock.", "presence"},
    {kBatteryV, "robot_battery_v", "", "Voltage of the battery.",
     "Robot State `battery_v`; status `battery.voltageV`; twin `battery/status`, `metrics`; drone "
     "`battery` of the lowest id"},
    {kBatteryPct, "robot_battery_pct", "", "Charge of the battery, percent.",
     "Robot State `battery_pct`; status `battery.socPct`; twin `battery/status` above 1 or 0, "
     "`metrics`, `telemetry`; drone `battery` of the lowest id"},
    {kBatteryTemperatureC, "robot_battery_temperature_c", "",
     "Temperature of the battery, degrees Celsius.",
     "status `battery.temperature`; drone `battery` of the lowest id"},
    {kBatteryCharging, "robot_battery_charging", "",
     "1 while the battery charges, 0 while it does not.",
     "status `battery.powerSupplyStatus`; twin `battery/status`, `telemetry`; drone `battery` of "
     "the "
     "lowest id by its current"},
    {kFuelPct, "robot_fuel_pct", "", "Fuel, percent.", "status `fuel.levelPct`"},
    {kUptimeMs, "robot_uptime_ms", "", "Milliseconds since the robot's process started.",
     "Robot State `uptime_ms`; twin `edge_health`"},
    {kBooted, "robot_booted_timestamp_seconds", "",
     "Unix time at which the robot's computer started, by the server's clock.",
     "agentInfo `uptimeS` at its arrival"},
    {kLatitudeDeg, "robot_latitude_deg", "", "Latitude, degrees.",
     "motion `pose`; twin `gps`; drone `position`"},
    {kLongitudeDeg, "robot_longitude_deg", "", "Longitude, degrees.",
     "motion `pose`; twin `gps`; drone `position`"},
    {kAltitudeM, "robot_altitude_m", "", "Altitude, metres.", "motion `pose`; twin `gps`"},
    {kHeadingDeg, "robot_heading_deg", "", "Heading, degrees clockwise from north.",
     "motion `pose`; twin `gps`; drone `heading`"},
    {kSpeedMS, "robot_speed_m_s", "", "Speed, of a drone over the ground, metres a second.",
     "motion `velocity.linearMps`; drone `velocityNed`"},
    {kTurnRateRadS, "robot_turn_rate_rad_s", "", "Turn rate, radians a second.",
     "motion `velocity.angularRps`"},
    {kPositionXM, "robot_position_x_m", "",
     "Position in the robot's own frame, of a twin in its world's, metres.",
     "Robot State `position`; twin `position`"},
    {kPositionYM, "robot_position_y_m", "",
     "Position in the robot's own frame, of a twin in its world's, metres.",
     "Robot State `position`; twin `position`"},
    {kPositionZM, "robot_position_z_m", "", "Height of a twin in its world's frame, metres.",
     "twin `position`"},
    {kPositionHeadingRad, "robot_position_heading_rad", "",
     "Heading in the robot's own frame, of a twin in its world's, radians counter-clockwise.",
     "Robot State `position`; twin `rotation`"},
    {kRangeRemainingM, "robot_range_remaining_m", "", "Distance that the robot can still go.",
     "status `rangeRemaining`"},
    {kRuntimeRemainingS, "robot_runtime_remaining_s", "", "Time that the robot can still run.",
     "status `runtimeRemaining`; twin `metrics`"},
    {kEstop, "robot_estop", "", "1 while an emergency stop is engaged.", "status `estop.active`"},
    {kFaulted, "robot_faulted", "", "1 while the robot says that it is faulted.",
     "status `faulted`"},
    {kAcceptingMissions, "robot_accepting_missions", "", "1 while the robot can accept missions.",
     "status `missionActive`"},
    {kActiveFaults, "robot_active_faults", "severity", "Faults that are active.", "faults"},
    {kMissionProgressPct, "robot_mission_progress_pct", "",
     "Progress of the open mission run with the latest report, of a drone its plan, percent.",
     "missionRunStatus `progressX100`; drone `currentMissionItem`"},
    {kMissionFailed, "robot_mission_failed_timestamp_seconds", "",
     "Unix time at which the last mission run that failed was reported, since the server's start.",
     "missionRunStatus with status `error`"},
    {kAltitudeAmslM, "robot_altitude_amsl_m", "",
     "Altitude of a drone above mean sea level, metres.", "drone `altitude`; `position`"},
    {kAltitudeRelativeM, "robot_altitude_relative_m", "",
     "Altitude of a drone above its place of take-off, metres.", "drone `altitude`; `position`"},
    {kAltitudeTerrainM, "robot_altitude_terrain_m", "",
     "Altitude of a drone above the ground below, metres.", "drone `altitude`"},
    {kClimbRateMS, "robot_climb_rate_m_s", "", "Climb rate, metres a second, upwards.",
     "drone `velocityNed`"},
    {kRollDeg, "robot_roll_deg", "", "Roll, degrees, to the right.", "drone `poseEuler`"},
    {kPitchDeg, "robot_pitch_deg", "", "Pitch, degrees, nose up.", "drone `poseEuler`"},
    {kBatteryCurrentA, "robot_battery_current_a", "",
     "Current of the battery, amperes; positive: it discharges.",
     "drone `battery` of the lowest id"},
    {kGpsSatellites, "robot_gps_satellites", "", "Satellites that the drone receives.",
     "drone `gpsInfo`"},
    {kGpsFixType, "robot_gps_fix_type", "",
     "Fix: 0 no receiver, 1 none, 2 2D, 3 3D, 4 differential, 5 RTK float, 6 RTK fixed.",
     "drone `gpsInfo`"},
    {kArmed, "robot_armed", "", "1 while the drone is armed.", "drone `armed`"},
    {kArmable, "robot_armable", "", "1 while the drone could be armed.", "drone `health`"},
    {kWinchLineM, "robot_winch_line_m", "winch", "Line of the winch that is out, metres.",
     "drone `winchStatus`"},
    {kWinchTensionKg, "robot_winch_tension_kg", "winch", "Tension of the winch's line, kilograms.",
     "drone `winchStatus`"},
    {kDistanceM, "robot_distance_m", "sensor", "What the drone's distance sensor measures, metres.",
     "drone `distanceSensor`"},
    {kCpuPct, "robot_cpu_pct", kDevice, "Load of the device's processor, percent.",
     "systemHealth; twin `edge_health`"},
    {kMemPct, "robot_mem_pct", kDevice, "Memory of the device in use, percent.",
     "systemHealth; twin `edge_health`"},
    {kDiskPct, "robot_disk_pct", kDevice, "Disk of the device in use, percent.",
     "systemHealth; twin `edge_health`"},
    {kCpuTemperatureC, "robot_cpu_temperature_c", kDevice,
     "Temperature of the device's processor, degrees Celsius.", "systemHealth; twin `edge_health`"},
    {kStreams, "robot_streams", kDevice, "Streams of the edge device: cameras, microphones.",
     "twin `edge_health`"},
    {kStreamsHealthy, "robot_streams_healthy", kDevice,
     "Streams of the edge device that are healthy.", "twin `edge_health`"},
    {kExtra, "robot_extra", "key",
     "A number or boolean of extras (rcan.extras), or of a twin's metrics.",
     "extras; twin `metrics`, as `metrics/CATEGORY/NAME`"},
    {kTop, "uplinkd_top_robots", "by",
     "What the ten robots that send most send per second now; `by`: messages or bytes.",
     "all messages of the last minute or so"},
});
static_assert(kSpecs.size() == kSeries, "each SeriesId has one entry");

constexpr bool InOrder() {
  for (std::size_t i = 0; i < kSpecs.size(); ++i) {
    if (static_cast<std::size_t>(kSpecs[i].id) != i) return false;
    if ((i < kJointSeries) != (kSpecs[i].label == kJoint)) return false;
  }
  return true;
}
static_assert(InOrder(), "the table stands in the order of SeriesId, joints first");

}  // namespace

std::span<const SeriesSpec> AllSeries() { return kSpecs; }

std::string_view TakeLabel(std::string_view& labels) {
  const std::string_view label = labels.substr(0, labels.find(','));
  labels.remove_prefix(std::min(label.size() + 1, labels.size()));
  return label;
}

std::string ShortName(const SeriesSpec& spec, std::string_view subsystem) {
  if (static_cast<std::size_t>(spec.id) >= kJointSeries) return std::string(spec.name);
  return fmt::format("{}_{}", subsystem, spec.name);
}

std::size_t JointSeriesOf(std::string_view field) {
  for (std::size_t i = 0; i < kJointSeries; ++i) {
    if (kSpecs[i].name == field) return i;
  }
  return kSeries;
}

std::string FullName(const SeriesSpec& spec, std::string_view subsystem) {
  if (spec.name.starts_with(kOurs)) return std::string(spec.name);
  return "rcan_" + ShortName(spec, subsystem);
}

std::string SeriesTable(std::string_view subsystem) {
  std::string table = "| name | labels | is | from |\n| --- | --- | --- | --- |\n";
  for (const SeriesSpec& spec : kSpecs) {
    std::string labels;
    std::string_view rest = spec.label;
    while (!rest.empty()) labels += fmt::format("`{}`, ", TakeLabel(rest));
    table += fmt::format("| `{}` | {}`ruri` | {} | {} |\n", FullName(spec, subsystem), labels,
                         spec.help, spec.source);
  }
  return table;
}

}  // namespace uplink::metrics::rcan
