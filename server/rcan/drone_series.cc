#include "server/rcan/drone_series.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <variant>

#include "server/view/vitals.h"

namespace uplink::rcan {
namespace {

namespace un = model::uncrew;
using metrics::rcan::SeriesId;
using metrics::rcan::SeriesPage;
using enum metrics::rcan::SeriesId;

constexpr double kPercent = 100;

/// The fresh samples of a drone.
class Fresh {
 public:
  Fresh(const uncrew::LiveSamples& live, SteadyTime since) : live_(live), since_(since) {}

  /// Calls `take` with each fresh value of the type.
  template <typename Type, typename Take>
  void Each(Take take) const {
    for (const uncrew::LiveSample& sample : live_.Of(un::TypeOf(Type{}))) {
      if (sample.received_steady >= since_) take(std::get<Type>(sample.value));
    }
  }
  /// The same for a type without keys.
  template <typename Type>
  [[nodiscard]] const Type* Of() const {
    const Type* found = nullptr;
    Each<Type>([&](const Type& value) { found = &value; });
    return found;
  }

 private:
  const uncrew::LiveSamples& live_;
  const SteadyTime since_;
};

/// The same, and the page for them.
class Basic final : public Fresh {
 public:
  Basic(const Fresh& fresh, SeriesPage& page) : Fresh(fresh), page_(page) {}

  /// Adds a known value, unless a stream of the robot reported it.
  template <typename Number>
  void Add(SeriesId id, const std::optional<Number>& value) const {
    if (value && !page_.Has(id)) page_.Add(id, static_cast<double>(*value));
  }

 private:
  SeriesPage& page_;
};

std::optional<double> AsDouble(const std::optional<float>& value) {
  return value ? std::optional(double{*value}) : std::nullopt;
}

void AddVitals(const view::Vitals& vitals, const Basic& fresh) {
  fresh.Add(kBatteryV, vitals.battery_v);
  fresh.Add(kBatteryPct, vitals.battery_percent);
  fresh.Add(kBatteryCharging, vitals.battery_charging);
  if (!vitals.place) return;
  fresh.Add(kLatitudeDeg, std::optional(vitals.place->latitude_deg));
  fresh.Add(kLongitudeDeg, std::optional(vitals.place->longitude_deg));
}

void AddAltitude(const Basic& fresh) {
  std::optional<float> amsl;
  std::optional<float> relative;
  if (const auto* altitude = fresh.Of<un::Altitude>()) {
    amsl = altitude->altitude_amsl_m;
    relative = altitude->altitude_relative_m;
    fresh.Add(kAltitudeTerrainM, altitude->altitude_terrain_m);
  }
  if (const auto* position = fresh.Of<un::Position>()) {
    if (!amsl) amsl = position->absolute_altitude_m;
    if (!relative) relative = position->relative_altitude_m;
  }
  fresh.Add(kAltitudeAmslM, amsl);
  fresh.Add(kAltitudeRelativeM, relative);
}

void AddMotion(const Basic& fresh) {
  if (const auto* velocity = fresh.Of<un::VelocityNed>()) {
    if (velocity->north_m_s && velocity->east_m_s) {
      fresh.Add(kSpeedMS, std::optional(std::hypot(double{*velocity->north_m_s},
                                                   double{*velocity->east_m_s})));
    }
    if (velocity->down_m_s) fresh.Add(kClimbRateMS, std::optional(-*velocity->down_m_s));
  }
  if (const auto* heading = fresh.Of<un::Heading>()) fresh.Add(kHeadingDeg, heading->heading_deg);
  if (const auto* pose = fresh.Of<un::PoseEuler>()) {
    fresh.Add(kRollDeg, pose->roll_deg);
    fresh.Add(kPitchDeg, pose->pitch_deg);
  }
}

void AddBattery(const Basic& fresh) {
  const un::Battery* first = nullptr;
  fresh.Each<un::Battery>([&](const un::Battery& battery) {
    if (first == nullptr || battery.key < first->key) first = &battery;
  });
  if (first == nullptr) return;
  fresh.Add(kBatteryTemperatureC, first->temperature_degc);
  fresh.Add(kBatteryCurrentA, first->current_battery_a);
}

void AddState(const Basic& fresh) {
  if (const auto* gps = fresh.Of<un::GpsInfo>()) {
    fresh.Add(kGpsSatellites, gps->num_satellites);
    if (gps->fix_type) {
      fresh.Add(kGpsFixType, std::optional(static_cast<std::int32_t>(*gps->fix_type)));
    }
  }
  if (const auto* armed = fresh.Of<un::Armed>()) fresh.Add(kArmed, armed->is_armed);
  if (const auto* health = fresh.Of<un::Health>()) fresh.Add(kArmable, health->is_armable);
  const auto* item = fresh.Of<un::CurrentMissionItem>();
  if (item != nullptr && item->current && item->total && *item->total > 0) {
    fresh.Add(kMissionProgressPct, std::optional(kPercent * *item->current / *item->total));
  }
}

}  // namespace

void AddDroneBasic(const uncrew::LiveSamples& live, SteadyTime now, milliseconds stale_after,
                   metrics::rcan::SeriesPage& page) {
  const SteadyTime since = now - stale_after;
  const Basic fresh(Fresh(live, since), page);
  AddVitals(view::VitalsOf({.drone = &live, .drone_since = since}), fresh);
  AddAltitude(fresh);
  AddMotion(fresh);
  AddBattery(fresh);
  AddState(fresh);
}

void AddDroneNamed(const uncrew::LiveSamples& live, SteadyTime now, milliseconds stale_after,
                   NamedSeries& series) {
  const Fresh fresh(live, now - stale_after);
  fresh.Each<un::WinchStatus>([&](const un::WinchStatus& winch) {
    // In the order of SeriesId.
    const std::array<std::optional<double>, 2> samples = {AsDouble(winch.line_length_m),
                                                          AsDouble(winch.tension_kg)};
    series.Add(kWinchLineM, std::to_string(winch.key), samples);
  });
  fresh.Each<un::DistanceSensor>([&](const un::DistanceSensor& sensor) {
    const std::array<std::optional<double>, 1> sample = {AsDouble(sensor.current_distance_m)};
    series.Add(kDistanceM, std::to_string(sensor.key), sample);
  });
}

}  // namespace uplink::rcan
