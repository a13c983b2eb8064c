#pragma once

#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/cyberwave/health.h"
#include "server/cyberwave/twin_parts.h"
#include "server/robot/live_parts.h"
#include "server/uncrew/live_samples.h"

namespace uplink::view {

/// Battery, position and e-stop of one robot. What no source reported is empty. A value.
struct Vitals {
  /// WGS 84.
  struct Place {
    double latitude_deg = 0;
    double longitude_deg = 0;
    /// As its source means it: above the ellipsoid, or of a drone above mean sea level.
    std::optional<double> altitude_m{};
  };
  /// In a frame of the robot's own, or of its environment.
  struct LocalPlace {
    double x_m = 0;
    double y_m = 0;
    std::optional<double> z_m{};
  };

  /// 0 to 100.
  std::optional<double> battery_percent{};
  std::optional<double> battery_v{};
  std::optional<bool> battery_charging{};
  std::optional<Place> place{};
  std::optional<LocalPlace> local_place{};
  std::optional<bool> estop{};
};

/// Where a robot's vitals come from; null: not from there. A view: it is used at once.
struct VitalsSources {
  /// Of Rover Nexus and of RCAN, and when they arrived, as robot::StateView has it.
  const robot::LiveParts* parts = nullptr;
  SteadyTime status_arrived{};
  SteadyTime rcan_arrived{};
  /// Of Cyberwave.
  const cyberwave::TwinParts* twin = nullptr;
  /// Of Uncrew; samples before `drone_since` do not count.
  const uncrew::LiveSamples* drone = nullptr;
  SteadyTime drone_since{};
};

/// The vitals of a robot, whatever its source: what `/metrics/robots` and `/api/v1` show. Of one
/// with several sources a stream comes first, then a broker, then calls. What is in `known`, from
/// sources that come first, stays. Pure; under the locks of the sources.
[[nodiscard]] Vitals VitalsOf(const VitalsSources& sources, Vitals known = {});

/// The category of a twin's metrics that tells its battery, and the names there.
inline constexpr std::string_view kPowerCategory = "power";
inline constexpr std::string_view kBatteryPercentMetric = "battery_percent";
inline constexpr std::string_view kVoltageMetric = "voltage";
/// A metric as a number, if it is one: true is 1. Pure.
[[nodiscard]] std::optional<double> NumberOf(const model::cyberwave::MetricValue& value);
/// The metric of that name, if it is a number. Null: the twin has no such category. Pure.
[[nodiscard]] std::optional<double> MetricIn(const cyberwave::MetricCategory* category,
                                             std::string_view name);

}  // namespace uplink::view
