#include "server/rcan/robot_series.h"

#include <array>
#include <optional>
#include <string_view>

#include "schema/model/reports.h"
#include "server/rcan/joint_series.h"
#include "server/view/vitals.h"

namespace uplink::rcan {
namespace {

using metrics::rcan::SeriesPage;
using enum metrics::rcan::SeriesId;

constexpr double kMillisPerSecond = 1000;
constexpr std::string_view kUnrecognized = "unrecognized";

double UnixSeconds(SystemTime time) { return static_cast<double>(UnixMs(time)) / kMillisPerSecond; }

template <typename Number>
void AddIf(SeriesPage& page, metrics::rcan::SeriesId id, const std::optional<Number>& value) {
  if (value) page.Add(id, static_cast<double>(*value));
}

/// Whether that happened so lately that values from then are still shown.
bool IsLately(SteadyTime at, const SeriesSources& sources) {
  return at != SteadyTime() &&
         sources.steady_now - at <= sources.presence_timeout + sources.series_ttl;
}

bool ShowsValues(const robot::StateView& view, const SeriesSources& sources) {
  // The time of the last change of presence does not help: after a restart it is later than the
  // beginning of the robot's silence.
  if (view.presence == robot::Presence::kOnline || view.held_back) return true;
  // Silence that we caused does not count.
  if (IsLately(view.stream_held_back_until.value_or(SteadyTime()), sources)) return true;
  return view.last_sign_of_life &&
         sources.now - *view.last_sign_of_life <= sources.presence_timeout + sources.series_ttl;
}

void AddMotion(const model::MotionTelemetry& motion, SeriesPage& page) {
  if (motion.pose) AddIf(page, kHeadingDeg, motion.pose->heading_deg);
  if (motion.velocity) {
    AddIf(page, kSpeedMS, motion.velocity->linear_mps);
    AddIf(page, kTurnRateRadS, motion.velocity->angular_rps);
  }
}

void AddStatus(const model::StatusTelemetry& status, SeriesPage& page) {
  if (status.battery) AddIf(page, kBatteryTemperatureC, status.battery->temperature);
  if (status.fuel) AddIf(page, kFuelPct, status.fuel->level_pct);
  AddIf(page, kRangeRemainingM, status.range_remaining);
  AddIf(page, kRuntimeRemainingS, status.runtime_remaining);
  page.Add(kFaulted, status.faulted ? 1 : 0);
  page.Add(kAcceptingMissions, status.mission_active ? 1 : 0);
}

/// Battery, place and e-stop.
void AddVitals(const view::Vitals& vitals, SeriesPage& page) {
  AddIf(page, kBatteryV, vitals.battery_v);
  AddIf(page, kBatteryPct, vitals.battery_percent);
  AddIf(page, kBatteryCharging, vitals.battery_charging);
  if (vitals.place) {
    page.Add(kLatitudeDeg, vitals.place->latitude_deg);
    page.Add(kLongitudeDeg, vitals.place->longitude_deg);
    AddIf(page, kAltitudeM, vitals.place->altitude_m);
  }
  if (vitals.local_place) {
    page.Add(kPositionXM, vitals.local_place->x_m);
    page.Add(kPositionYM, vitals.local_place->y_m);
    AddIf(page, kPositionZM, vitals.local_place->z_m);
  }
  AddIf(page, kEstop, vitals.estop);
}

void AddRcan(const model::RcanState& state, SeriesPage& page) {
  AddIf(page, kUptimeMs, state.uptime_ms);
  if (state.position) AddIf(page, kPositionHeadingRad, state.position->heading_rad);
}

/// Adds a robot whose Robot States alone are shown.
void AddState(const model::RcanState& state, SeriesPage& page) {
  robot::LiveParts alone;
  model::RcanState& without_joints = alone.rcan.emplace();
  without_joints.battery_v = state.battery_v;
  without_joints.battery_pct = state.battery_pct;
  without_joints.position = state.position;
  AddVitals(view::VitalsOf({.parts = &alone}), page);
  AddRcan(state, page);
}

void AddFaults(const std::string& ruri, const view::FaultCounts::Map& faults, SeriesPage& page) {
  const auto found = faults.find(ruri);
  const view::FaultCounts::BySeverity counts =
      found == faults.end() ? view::FaultCounts::BySeverity{} : found->second;
  const auto& names = model::kEnumNames<model::FaultSeverity>;
  for (std::size_t i = 0; i < names.size(); ++i) {
    page.Add(kActiveFaults, names[i], static_cast<double>(counts[i]));
  }
  if (counts.back() > 0) {
    page.Add(kActiveFaults, kUnrecognized, static_cast<double>(counts.back()));
  }
}

void AddReported(const robot::Reported& reported, SeriesPage& page) {
  if (reported.booted_at) page.Add(kBooted, UnixSeconds(*reported.booted_at));
  if (reported.mission_failed_at) {
    page.Add(kMissionFailed, UnixSeconds(*reported.mission_failed_at));
  }
  const auto& runs = reported.open_runs.items();
  if (!runs.empty()) AddIf(page, kMissionProgressPct, runs.back().second);
}

void AddHealth(const robot::LiveParts& parts, NamedSeries& series) {
  for (const auto& [device, health] : parts.health.items()) {
    // In the order of SeriesId.
    const std::array<std::optional<double>, 4> samples = {health.cpu_pct, health.mem_pct,
                                                          health.disk_pct, health.cpu_temp};
    series.Add(kCpuPct, device, samples);
  }
}

void AddExtras(const robot::LiveParts& parts, std::span<const std::string> keys,
               NamedSeries& series) {
  for (const std::string& key : keys) {
    const robot::Extra* extra = parts.extras.Find(key);
    if (extra == nullptr) continue;
    const std::array<std::optional<double>, 1> sample = {NumberOf(extra->value)};
    series.Add(kExtra, key, sample);
  }
}

Shown ShownOf(const robot::StateView& view, const SeriesSources& sources) {
  if (ShowsValues(view, sources)) return Shown::kAll;
  return view.parts.rcan && IsLately(view.rcan_arrived, sources) ? Shown::kStates
                                                                 : Shown::kPresence;
}

void AddValues(const std::string& ruri, const robot::StateView& view, const SeriesSources& sources,
               SeriesPage& page) {
  AddVitals(view::VitalsOf({.parts = &view.parts,
                            .status_arrived = view.status_arrived,
                            .rcan_arrived = view.rcan_arrived}),
            page);
  if (view.parts.motion) AddMotion(*view.parts.motion, page);
  if (view.parts.status) AddStatus(*view.parts.status, page);
  if (view.parts.rcan) AddRcan(*view.parts.rcan, page);
  AddReported(view.reported, page);
  if (sources.faults != nullptr) AddFaults(ruri, *sources.faults, page);
}

}  // namespace

Shown AddBasic(const std::string& ruri, const robot::StateView& view, const SeriesSources& sources,
               SeriesPage& page) {
  // The holder of a robot has its series, so that no robot counts twice in a sum over servers.
  if (view.foreign) return Shown::kPresence;
  // A robot that is neither heard nor known to be silent has no sample.
  if (view.presence != robot::Presence::kUnknown) {
    page.Add(kOnline, view.presence == robot::Presence::kOnline ? 1 : 0);
  }
  if (view.last_sign_of_life) page.Add(kLastSignOfLife, UnixSeconds(*view.last_sign_of_life));
  const Shown shown = ShownOf(view, sources);
  if (shown == Shown::kAll) AddValues(ruri, view, sources, page);
  if (shown == Shown::kStates) AddState(*view.parts.rcan, page);
  return shown;
}

void AddNamed(const robot::StateView& view, Shown shown, std::span<const std::string> extras,
              NamedSeries& series) {
  if (view.foreign || shown == Shown::kPresence) return;
  if (shown == Shown::kStates) {
    if (view.parts.rcan) AddJoints(*view.parts.rcan, series);
    return;
  }
  AddExtras(view.parts, extras, series);
  AddHealth(view.parts, series);
  AddJoints(view, series);
}

}  // namespace uplink::rcan
