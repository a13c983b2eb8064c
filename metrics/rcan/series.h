#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace uplink::metrics::rcan {

/// The second word of the names of joints' series, unless it is set.
inline constexpr std::string_view kSubsystemDefault = "acb";

/// The robots' series by RCAN's label convention (section 20), in the order of the text; all are
/// gauges. A series exists by its entry here and in the table of series.cc.
enum class SeriesId : std::uint8_t {
  kJointPositionRad,
  kJointVelocityRadS,
  kJointPositionM,
  kJointVelocityMS,
  kJointEffortNm,
  kJointTemperatureC,
  kJointErrorFlags,
  kInfo,
  kOnline,
  kLastSignOfLife,
  kBatteryV,
  kBatteryPct,
  kBatteryTemperatureC,
  kBatteryCharging,
  kFuelPct,
  kUptimeMs,
  kBooted,
  kLatitudeDeg,
  kLongitudeDeg,
  kAltitudeM,
  kHeadingDeg,
  kSpeedMS,
  kTurnRateRadS,
  kPositionXM,
  kPositionYM,
  kPositionZM,
  kPositionHeadingRad,
  kRangeRemainingM,
  kRuntimeRemainingS,
  kEstop,
  kFaulted,
  kAcceptingMissions,
  kActiveFaults,
  kMissionProgressPct,
  kMissionFailed,
  kAltitudeAmslM,
  kAltitudeRelativeM,
  kAltitudeTerrainM,
  kClimbRateMS,
  kRollDeg,
  kPitchDeg,
  kBatteryCurrentA,
  kGpsSatellites,
  kGpsFixType,
  kArmed,
  kArmable,
  kWinchLineM,
  kWinchTensionKg,
  kDistanceM,
  kCpuPct,
  kMemPct,
  kDiskPct,
  kCpuTemperatureC,
  kStreams,
  kStreamsHealthy,
  kExtra,
  kTop,
};
inline constexpr std::size_t kSeries = static_cast<std::size_t>(SeriesId::kTop) + 1;
inline constexpr std::size_t kJointSeries =
    static_cast<std::size_t>(SeriesId::kJointErrorFlags) + 1;

/// What is declared of one series. Immutable.
struct SeriesSpec {
  SeriesId id;
  /// Of a joint's series the field with its unit (`position_rad`); of one that RCAN does not name
  /// the whole name (`uplinkd_...`); else `robot_...`.
  std::string_view name;
  /// The labels beside `ruri`, separated by commas; empty: none.
  std::string_view label;
  /// One sentence, units included.
  std::string_view help;
  /// Where the value comes from, for the reference page.
  std::string_view source;
};

/// Takes the first of such labels.
[[nodiscard]] std::string_view TakeLabel(std::string_view& labels);

/// All series, by SeriesId.
[[nodiscard]] std::span<const SeriesSpec> AllSeries();

/// The name in a scrape: `rcan_acb_position_rad`, `rcan_robot_battery_pct`.
[[nodiscard]] std::string FullName(const SeriesSpec& spec, std::string_view subsystem);
/// The name without `rcan_`: `acb_position_rad`, `robot_battery_pct`.
[[nodiscard]] std::string ShortName(const SeriesSpec& spec, std::string_view subsystem);

/// The joints' series whose field and unit are spelled so (`position_rad`); kSeries if none is.
[[nodiscard]] std::size_t JointSeriesOf(std::string_view field);

/// The table as Markdown, for the reference page.
[[nodiscard]] std::string SeriesTable(std::string_view subsystem);

}  // namespace uplink::metrics::rcan
