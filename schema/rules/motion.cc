#include "schema/rules/motion.h"

#include <cmath>

#include "schema/limits.h"
#include "schema/rules/numbers.h"

namespace uplink::schema {
namespace {

constexpr double kTurnDeg = 360;
constexpr Bounds kLatitude = {-kLatitudeDegMax, kLatitudeDegMax};
constexpr Bounds kLongitude = {-kLongitudeDegMax, kLongitudeDegMax};
constexpr Bounds kAltitude = {kAltitudeMMin, kAltitudeMMax};

}  // namespace

double NormalizedHeading(double heading_deg) {
  if (heading_deg >= 0 && heading_deg < kTurnDeg) return heading_deg + 0.0;  // -0 becomes 0
  double heading = std::fmod(heading_deg, kTurnDeg);
  if (heading < 0) heading += kTurnDeg;
  // A tiny negative angle rounds up to a whole turn.
  return heading >= kTurnDeg ? 0.0 : heading + 0.0;
}

std::optional<model::Pose> JudgePose(Violations& violations, const Path& path, const RawPose& raw) {
  const auto lat = InRange(violations, path.Field("latDeg"), raw.lat_deg, kLatitude);
  if (!lat) return std::nullopt;
  const auto lon = InRange(violations, path.Field("lonDeg"), raw.lon_deg, kLongitude);
  if (!lon) return std::nullopt;
  model::Pose pose{.lat_deg = *lat, .lon_deg = *lon, .altitude_m = {}, .heading_deg = {}};
  pose.altitude_m = UnlessNan(raw.altitude_m, [&](double altitude) {
    return InRange(violations, path.Field("altitudeM"), altitude, kAltitude);
  });
  pose.heading_deg = UnlessNan(raw.heading_deg, [&](double heading) {
    return Finite(violations, path.Field("headingDeg"), heading);
  });
  if (pose.heading_deg) pose.heading_deg = NormalizedHeading(*pose.heading_deg);
  return pose;
}

}  // namespace uplink::schema
