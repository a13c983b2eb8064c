#include "server/view/vitals.h"

#include <variant>

namespace uplink::view {
namespace {

namespace cw = model::cyberwave;
namespace un = model::uncrew;

/// Takes a value if it is known, and none was before.
template <typename Value, typename Found>
void Fill(std::optional<Value>& value, const std::optional<Found>& found) {
  if (!value && found) value = static_cast<Value>(*found);
}

// --- Rover Nexus and RCAN ---

/// The fresher of two sources; the Robot State if both came at once, or neither since the start.
template <typename Ours, typename Rcan>
std::optional<double> Fresher(const std::optional<Ours>& status, const std::optional<Rcan>& rcan,
                              bool status_is_fresher) {
  if (rcan && !(status && status_is_fresher)) return static_cast<double>(*rcan);
  if (status) return static_cast<double>(*status);
  return std::nullopt;
}

void AddParts(const VitalsSources& sources, Vitals& vitals) {
  const robot::LiveParts& parts = *sources.parts;
  const model::BatteryStatus none;
  const auto& status = parts.status;
  const model::BatteryStatus& battery = status && status->battery ? *status->battery : none;
  const model::RcanState nothing;
  const model::RcanState& rcan = parts.rcan ? *parts.rcan : nothing;
  const bool status_is_fresher = sources.status_arrived > sources.rcan_arrived;
  Fill(vitals.battery_percent, Fresher(battery.soc_pct, rcan.battery_pct, status_is_fresher));
  Fill(vitals.battery_v, Fresher(battery.voltage_v, rcan.battery_v, status_is_fresher));
  if (!vitals.battery_charging &&
      battery.power_supply_status != model::PowerSupplyStatus::kUnknown) {
    vitals.battery_charging = battery.power_supply_status == model::PowerSupplyStatus::kCharging;
  }
  if (!vitals.place && parts.motion && parts.motion->pose) {
    const model::Pose& pose = *parts.motion->pose;
    vitals.place = Vitals::Place{pose.lat_deg, pose.lon_deg, pose.altitude_m};
  }
  if (!vitals.local_place && rcan.position) {
    vitals.local_place = Vitals::LocalPlace{rcan.position->x_m, rcan.position->y_m};
  }
  if (!vitals.estop && status && status->estop) vitals.estop = status->estop->active;
}

// --- Cyberwave ---

/// The value that arrived last, of several that may be there.
class Latest final {
 public:
  void Offer(const std::optional<double>& value, SteadyTime arrived) {
    if (!value || (value_ && arrived < arrived_)) return;
    value_ = value;
    arrived_ = arrived;
  }
  [[nodiscard]] const std::optional<double>& value() const { return value_; }

 private:
  std::optional<double> value_;
  SteadyTime arrived_{};
};

/// Older drivers mean 0 to 1: up to 1 the unit is unknown.
bool IsAmbiguous(double percentage) { return percentage > 0 && percentage <= 1; }

void AddTwinBattery(const cyberwave::TwinParts& parts, Vitals& vitals) {
  Latest percent;
  Latest voltage;
  Latest charging;
  if (const cyberwave::MetricCategory* power = parts.metrics.Find(kPowerCategory)) {
    const SteadyTime arrived = power->stamp.arrived.steady;
    percent.Offer(MetricIn(power, kBatteryPercentMetric), arrived);
    voltage.Offer(MetricIn(power, kVoltageMetric), arrived);
  }
  if (const cyberwave::HeldReport* report = parts.reports.Find("battery")) {
    percent.Offer(report->value.battery_percent, report->stamp.arrived.steady);
    charging.Offer(report->value.battery_charging, report->stamp.arrived.steady);
  }
  if (parts.battery) {
    const cw::BatteryStatus& battery = parts.battery->value;
    const SteadyTime arrived = parts.battery->stamp.arrived.steady;
    if (battery.percentage && !IsAmbiguous(*battery.percentage)) {
      percent.Offer(battery.percentage, arrived);
    }
    voltage.Offer(battery.voltage_v, arrived);
    charging.Offer(battery.charging, arrived);
  }
  Fill(vitals.battery_percent, percent.value());
  Fill(vitals.battery_v, voltage.value());
  if (charging.value()) Fill(vitals.battery_charging, std::optional(*charging.value() > 0));
}

void AddTwin(const cyberwave::TwinParts& parts, Vitals& vitals) {
  AddTwinBattery(parts, vitals);
  if (!vitals.place && parts.gps) {
    const cw::Gps& gps = parts.gps->value;
    if (gps.latitude_deg && gps.longitude_deg) {
      vitals.place = Vitals::Place{*gps.latitude_deg, *gps.longitude_deg, gps.altitude_m};
    }
  }
  if (!vitals.local_place && parts.position) {
    const cw::Position& position = parts.position->value;
    vitals.local_place = Vitals::LocalPlace{position.x_m, position.y_m, position.z_m};
  }
}

// --- Uncrew ---

/// The newest of a type without keys; null if it does not count.
template <typename Type>
const Type* NewestOf(const VitalsSources& sources) {
  const uncrew::LiveSample* sample = sources.drone->Newest(un::TypeOf(Type{}));
  if (sample == nullptr || sample->received_steady < sources.drone_since) return nullptr;
  return &std::get<Type>(sample->value);
}

/// That of the lowest id.
const un::Battery* FirstBattery(const VitalsSources& sources) {
  const un::Battery* first = nullptr;
  for (const uncrew::LiveSample& sample : sources.drone->Of(un::SampleType::kBattery)) {
    if (sample.received_steady < sources.drone_since) continue;
    const auto& battery = std::get<un::Battery>(sample.value);
    if (first == nullptr || battery.key < first->key) first = &battery;
  }
  return first;
}

void AddDrone(const VitalsSources& sources, Vitals& vitals) {
  if (const un::Battery* battery = FirstBattery(sources)) {
    Fill(vitals.battery_percent, battery->remaining_percent);
    Fill(vitals.battery_v, battery->voltage_v);
    // Positive: it discharges.
    if (battery->current_battery_a) {
      Fill(vitals.battery_charging, std::optional(*battery->current_battery_a < 0));
    }
  }
  const auto* position = NewestOf<un::Position>(sources);
  if (vitals.place || position == nullptr || !position->latitude_deg || !position->longitude_deg) {
    return;
  }
  vitals.place = Vitals::Place{*position->latitude_deg, *position->longitude_deg};
  if (const auto* altitude = NewestOf<un::Altitude>(sources)) {
    Fill(vitals.place->altitude_m, altitude->altitude_amsl_m);
  }
  Fill(vitals.place->altitude_m, position->absolute_altitude_m);
}

}  // namespace

Vitals VitalsOf(const VitalsSources& sources, Vitals known) {
  if (sources.parts != nullptr) AddParts(sources, known);
  if (sources.twin != nullptr) AddTwin(*sources.twin, known);
  if (sources.drone != nullptr) AddDrone(sources, known);
  return known;
}

std::optional<double> NumberOf(const cw::MetricValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* on = std::get_if<bool>(&value)) return *on ? 1 : 0;
  return std::nullopt;
}

std::optional<double> MetricIn(const cyberwave::MetricCategory* category, std::string_view name) {
  if (category == nullptr) return std::nullopt;
  for (const cw::Metric& metric : category->value) {
    if (metric.name == name) return NumberOf(metric.value);
  }
  return std::nullopt;
}

}  // namespace uplink::view
