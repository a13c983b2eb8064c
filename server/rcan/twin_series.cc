#include "server/rcan/twin_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "server/view/vitals.h"

namespace uplink::rcan {
namespace {

namespace cw = model::cyberwave;
using cyberwave::HeldJoint;
using cyberwave::JointGroup;
using cyberwave::TwinParts;
using metrics::rcan::SeriesPage;
using enum metrics::rcan::SeriesId;

constexpr double kMillisPerSecond = 1000;
constexpr double kSecondsPerMinute = 60;
/// Also a metric that has a series of its own.
constexpr std::string_view kRuntimeMinutes = "estimated_runtime_minutes";

template <typename Number>
void AddIf(SeriesPage& page, metrics::rcan::SeriesId id, const std::optional<Number>& value) {
  if (value) page.Add(id, static_cast<double>(*value));
}

/// A product may exceed a double.
void AddFinite(SeriesPage& page, metrics::rcan::SeriesId id, double value) {
  if (std::isfinite(value)) page.Add(id, value);
}

bool HasOwnSeries(const cw::Metric& metric) {
  return metric.category == view::kPowerCategory &&
         (metric.name == view::kBatteryPercentMetric || metric.name == view::kVoltageMetric ||
          metric.name == kRuntimeMinutes);
}

void AddVitals(const TwinParts& parts, SeriesPage& page) {
  const view::Vitals vitals = view::VitalsOf({.twin = &parts});
  AddIf(page, kBatteryV, vitals.battery_v);
  AddIf(page, kBatteryPct, vitals.battery_percent);
  AddIf(page, kBatteryCharging, vitals.battery_charging);
  if (vitals.place) {
    page.Add(kLatitudeDeg, vitals.place->latitude_deg);
    page.Add(kLongitudeDeg, vitals.place->longitude_deg);
  }
  if (vitals.local_place) {
    page.Add(kPositionXM, vitals.local_place->x_m);
    page.Add(kPositionYM, vitals.local_place->y_m);
    AddIf(page, kPositionZM, vitals.local_place->z_m);
  }
  const auto minutes = view::MetricIn(parts.metrics.Find(view::kPowerCategory), kRuntimeMinutes);
  if (minutes) AddFinite(page, kRuntimeRemainingS, *minutes * kSecondsPerMinute);
}

void AddBearing(const TwinParts& parts, SeriesPage& page) {
  if (parts.gps) {
    // A receiver without a fix may know its altitude.
    AddIf(page, kAltitudeM, parts.gps->value.altitude_m);
    AddIf(page, kHeadingDeg, parts.gps->value.compass_heading_deg);
  }
  if (parts.rotation) page.Add(kPositionHeadingRad, HeadingOf(parts.rotation->value));
}

/// The health of the twin's own driver, whose edge_id is the twin's id; otherwise that of the edge
/// that was heard last.
std::optional<double> UptimeOf(const TwinParts& parts) {
  if (const auto* driver = parts.edges.Find(parts.twin.ToText())) return driver->value.uptime_s;
  if (parts.edges.size() == 0) return std::nullopt;
  return parts.edges.items().back().second.value.value.uptime_s;
}

template <typename Number>
std::optional<double> AsDouble(const std::optional<Number>& number) {
  if (!number) return std::nullopt;
  return static_cast<double>(*number);
}

void AddEdges(const TwinParts& parts, NamedSeries& series) {
  for (const auto& [edge_id, sized] : parts.edges.items()) {
    const cw::EdgeHealth& health = sized.value.value;
    // In the order of SeriesId.
    const std::array<std::optional<double>, 6> samples = {
        health.host_cpu_percent, health.host_memory_percent,    health.host_disk_percent,
        health.cpu_temp_c,       AsDouble(health.stream_count), AsDouble(health.healthy_streams)};
    series.Add(kCpuPct, edge_id, samples);
  }
}

/// One channel of a joint that two sources report: the later one's, if it has it.
std::optional<double> ChannelOf(const HeldJoint& joint, const HeldJoint* other,
                                std::optional<double> HeldJoint::*channel) {
  if (other == nullptr || !(other->*channel)) return joint.*channel;
  const bool later = other->stamp.arrived.steady > joint.stamp.arrived.steady;
  return later || !(joint.*channel) ? other->*channel : joint.*channel;
}

void AddJoint(std::string_view name, const HeldJoint& joint, const HeldJoint* other,
              NamedSeries& series) {
  const auto position = ChannelOf(joint, other, &HeldJoint::position);
  const auto velocity = ChannelOf(joint, other, &HeldJoint::velocity);
  const auto effort = ChannelOf(joint, other, &HeldJoint::effort);
  const std::optional<double> none;
  // In the order of SeriesId: radians, then metres.
  const std::array<std::optional<double>, 5> samples =
      joint.prismatic ? std::array{none, none, position, velocity, effort}
                      : std::array{position, velocity, none, none, effort};
  series.Add(kJointPositionRad, name, samples);
}

/// The values of the robot's own arms. A leader arm, which a person moves by hand, has the same
/// names.
void AddJoints(const TwinParts& parts, NamedSeries& series) {
  const auto& edge = parts.joints.Of(JointGroup::kEdge);
  const auto& follower = parts.joints.Of(JointGroup::kFollower);
  for (const auto& [name, joint] : edge) {
    const auto same = follower.find(name);
    AddJoint(name, joint, same == follower.end() ? nullptr : &same->second, series);
  }
  for (const auto& [name, joint] : follower) {
    if (!edge.contains(name)) AddJoint(name, joint, nullptr, series);
  }
}

void AddMetrics(const TwinParts& parts, NamedSeries& series) {
  for (const auto& [category, sized] : parts.metrics.items()) {
    for (const cw::Metric& metric : sized.value.value) {
      const std::array<std::optional<double>, 1> sample = {view::NumberOf(metric.value)};
      if (!sample[0] || HasOwnSeries(metric)) continue;
      std::string key = "metrics/" + category;
      if (!metric.name.empty()) key.append("/").append(metric.name);
      series.Add(kExtra, key, sample);
    }
  }
}

}  // namespace

double HeadingOf(const cw::Rotation& rotation) {
  const double longest = std::max(
      {std::abs(rotation.w), std::abs(rotation.x), std::abs(rotation.y), std::abs(rotation.z)});
  // Scaled to at most 1 each, so that no square exceeds a double.
  const double w = rotation.w / longest;
  const double x = rotation.x / longest;
  const double y = rotation.y / longest;
  const double z = rotation.z / longest;
  return std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

void AddTwinBasic(const TwinParts& parts, SeriesPage& page) {
  AddVitals(parts, page);
  AddBearing(parts, page);
  if (const auto uptime_s = UptimeOf(parts)) {
    AddFinite(page, kUptimeMs, *uptime_s * kMillisPerSecond);
  }
}

void AddTwinNamed(const TwinParts& parts, NamedSeries& series) {
  AddEdges(parts, series);
  AddJoints(parts, series);
  AddMetrics(parts, series);
}

}  // namespace uplink::rcan
