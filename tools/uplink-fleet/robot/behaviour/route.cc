#include "tools/uplink-fleet/robot/behaviour/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace uplink::synthetic {
namespace {

constexpr std::size_t kWaypoints = 8;
constexpr double kAccelerationMps2 = 0.5;
constexpr double kTurnRpsMax = 0.8;
/// A waypoint counts as reached within it; wider than the tightest turn at the highest speed.
constexpr double kReachedM = 3;
constexpr double kFullTurn = 2 * std::numbers::pi;

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Into [-pi, pi).
double Wrapped(double angle) { return angle - kFullTurn * std::floor(angle / kFullTurn + 0.5); }

}  // namespace

model::GeoPoint2 Offset(const model::GeoPoint2& origin, double east_m, double north_m) {
  return {.lon = origin.lon + east_m / (kMetresADegree * std::cos(Radians(origin.lat))),
          .lat = origin.lat + north_m / kMetresADegree};
}

Route::Route(Seeded random)
    : origin_{.lon = random.Between(8.4, 8.6), .lat = random.Between(47.3, 47.5)},
      cruise_mps_(random.Between(0.8, 2)),
      altitude_m_(random.Between(390, 560)) {
  for (std::size_t i = 0; i < kWaypoints; ++i) {
    const double angle = kFullTurn * static_cast<double>(i) / kWaypoints;
    const double radius_m = random.Between(30, 90);
    waypoints_.push_back({radius_m * std::sin(angle), radius_m * std::cos(angle)});
  }
  at_ = waypoints_.front();
  next_ = 1;
  heading_rad_ = random.Between(0, kFullTurn);
}

void Route::Advance(const Moment& moment, Facts& facts) {
  const double wanted_mps = facts.may_drive() ? cruise_mps_ : 0;
  const double change = kAccelerationMps2 * moment.dt_s;
  facts.speed_mps += std::clamp(wanted_mps - facts.speed_mps, -2 * change, change);
  const Point& goal = waypoints_[next_];
  const double bearing = std::atan2(goal.east_m - at_.east_m, goal.north_m - at_.north_m);
  double turn = 0;
  if (facts.speed_mps > 0) {
    const double most = kTurnRpsMax * moment.dt_s;
    turn = std::clamp(Wrapped(bearing - heading_rad_), -most, most);
  }
  heading_rad_ = std::fmod(heading_rad_ + turn + kFullTurn, kFullTurn);
  // Turning to the left counts as positive, a heading to the right.
  facts.turn_rps = moment.dt_s > 0 ? -turn / moment.dt_s : 0;
  const double step_m = facts.speed_mps * moment.dt_s;
  at_.east_m += step_m * std::sin(heading_rad_);
  at_.north_m += step_m * std::cos(heading_rad_);
  facts.distance_m += step_m;
  if (step_m > 0) facts.driven_s += moment.dt_s;
  if (std::hypot(goal.east_m - at_.east_m, goal.north_m - at_.north_m) < kReachedM) {
    next_ = (next_ + 1) % kWaypoints;
  }
  const model::GeoPoint2 point = Offset(origin_, at_.east_m, at_.north_m);
  facts.pose = {.lat_deg = point.lat,
                .lon_deg = point.lon,
                .altitude_m = altitude_m_ + at_.north_m * 0.02,
                .heading_deg = std::min(heading_rad_ * 180 / std::numbers::pi, 359.999)};
}

model::MotionTelemetry Route::Motion(const Moment& moment, const Facts& facts) const {
  model::MotionTelemetry motion;
  motion.unix_time_ms = moment.now_ms;
  motion.pose = facts.pose;
  motion.velocity = model::VelTwist{.linear_mps = static_cast<float>(facts.speed_mps),
                                    .angular_rps = static_cast<float>(facts.turn_rps)};
  motion.gps_fix_type = model::GpsFixType::kFixedRtk;
  motion.gps_source = model::GpsSource::kSimulated;
  return motion;
}

model::Positions Route::Ahead() const {
  model::Positions points;
  for (std::size_t i = 0; i < kWaypoints; ++i) {
    const Point& point = waypoints_[(next_ + i) % kWaypoints];
    points.push_back(Offset(origin_, point.east_m, point.north_m));
  }
  return points;
}

}  // namespace uplink::synthetic
