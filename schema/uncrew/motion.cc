#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

#include "schema/uncrew/families.h"
#include "schema/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using schema::Bounds;

constexpr Bounds kLatitude = {-schema::kLatitudeDegMax, schema::kLatitudeDegMax};
constexpr Bounds kLongitude = {-schema::kLongitudeDegMax, schema::kLongitudeDegMax};
constexpr Bounds kHeight = {schema::kAltitudeMMin, schema::kAltitudeMMax};
constexpr Bounds kSpeed = {-schema::kLinearMpsMax, schema::kLinearMpsMax};
constexpr Bounds kRate = {-schema::kAngularRpsMax, schema::kAngularRpsMax};
constexpr Bounds kTemperature = {schema::kTemperatureCMin, schema::kTemperatureCMax};
/// Any number that is finite.
constexpr Bounds kAny = {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};

uc::FrdVector ReadFrd(Reader& in, const v1::FrdVector& from, Bounds bounds) {
  return {.forward = in.InRange("forward", from.has_forward(), from.forward(), bounds),
          .right = in.InRange("right", from.has_right(), from.right(), bounds),
          .down = in.InRange("down", from.has_down(), from.down(), bounds)};
}

uc::Xyz ReadXyz(Reader& in, const v1::TelemetryOdometry::Xyz& from, Bounds bounds) {
  return {.x = in.InRange("x", from.has_x(), from.x(), bounds),
          .y = in.InRange("y", from.has_y(), from.y(), bounds),
          .z = in.InRange("z", from.has_z(), from.z(), bounds)};
}

uc::Quaternion ReadQuaternion(Reader& in, const v1::TelemetryOdometry::Quaternion& from) {
  return {.w = in.Finite("w", from.has_w(), from.w()),
          .x = in.Finite("x", from.has_x(), from.x()),
          .y = in.Finite("y", from.has_y(), from.y()),
          .z = in.Finite("z", from.has_z(), from.z())};
}

uc::AngularVelocity ReadRates(Reader& in, const v1::TelemetryOdometry::AngularVelocity& from) {
  return {.roll = in.InRange("roll", from.has_roll(), from.roll(), kRate),
          .pitch = in.InRange("pitch", from.has_pitch(), from.pitch(), kRate),
          .yaw = in.InRange("yaw", from.has_yaw(), from.yaw(), kRate)};
}

/// All of its values or none: with one that is invalid it is no covariance.
std::vector<float> ReadCovariance(Reader& in, std::string_view name,
                                  const v1::TelemetryOdometry::Covariance& from) {
  const auto& values = from.covariance_matrix();
  const auto count = static_cast<std::size_t>(values.size());
  if (count == 0) return {};
  const schema::Path above = in.path().Field(name);
  const schema::Path path = above.Field("covariance_matrix");
  if (count != kCovarianceValues) {
    in.violations().Content(count > kCovarianceValues
                                ? schema::TooManyItems(path, count, kCovarianceValues, "values")
                                : schema::TooFewItems(path, count, kCovarianceValues, "values"));
    return {};
  }
  if (std::isnan(values[0])) return {};
  for (int i = 0; i < values.size(); ++i) {
    if (!schema::Finite(in.violations(), path.Item(static_cast<std::size_t>(i)), values[i])) {
      return {};
    }
  }
  return {values.begin(), values.end()};
}

}  // namespace

uc::Altitude Read(Reader& in, const v1::TelemetryAltitude& from) {
  return {
      .altitude_monotonic_m = in.InRange("altitude_monotonic_m", from.has_altitude_monotonic_m(),
                                         from.altitude_monotonic_m(), kHeight),
      .altitude_amsl_m = in.InRange("altitude_amsl_m", from.has_altitude_amsl_m(),
                                    from.altitude_amsl_m(), kHeight),
      .altitude_local_m = in.InRange("altitude_local_m", from.has_altitude_local_m(),
                                     from.altitude_local_m(), kHeight),
      .altitude_relative_m = in.InRange("altitude_relative_m", from.has_altitude_relative_m(),
                                        from.altitude_relative_m(), kHeight),
      .altitude_terrain_m = in.InRange("altitude_terrain_m", from.has_altitude_terrain_m(),
                                       from.altitude_terrain_m(), kHeight),
      .bottom_clearance_m = in.NotNegative("bottom_clearance_m", from.has_bottom_clearance_m(),
                                           from.bottom_clearance_m())};
}

uc::Position Read(Reader& in, const v1::TelemetryPosition& from) {
  uc::Position position{
      .latitude_deg =
          in.InRange("latitude_deg", from.has_latitude_deg(), from.latitude_deg(), kLatitude),
      .longitude_deg =
          in.InRange("longitude_deg", from.has_longitude_deg(), from.longitude_deg(), kLongitude),
      .absolute_altitude_m = in.InRange("absolute_altitude_m", from.has_absolute_altitude_m(),
                                        from.absolute_altitude_m(), kHeight),
      .relative_altitude_m = in.InRange("relative_altitude_m", from.has_relative_altitude_m(),
                                        from.relative_altitude_m(), kHeight)};
  // One without the other is no place.
  if (!position.latitude_deg) position.longitude_deg.reset();
  if (!position.longitude_deg) position.latitude_deg.reset();
  return position;
}

uc::VelocityNed Read(Reader& in, const v1::TelemetryVelocityNed& from) {
  return {.north_m_s = in.InRange("north_m_s", from.has_north_m_s(), from.north_m_s(), kSpeed),
          .east_m_s = in.InRange("east_m_s", from.has_east_m_s(), from.east_m_s(), kSpeed),
          .down_m_s = in.InRange("down_m_s", from.has_down_m_s(), from.down_m_s(), kSpeed)};
}

uc::Heading Read(Reader& in, const v1::TelemetryHeading& from) {
  uc::Heading heading{.heading_deg =
                          in.Finite("heading_deg", from.has_heading_deg(), from.heading_deg())};
  if (heading.heading_deg) heading.heading_deg = schema::NormalizedHeading(*heading.heading_deg);
  return heading;
}

uc::PoseEuler Read(Reader& in, const v1::TelemetryPoseEuler& from) {
  return {.roll_deg = in.Angle("roll_deg", from.has_roll_deg(), from.roll_deg()),
          .pitch_deg = in.Angle("pitch_deg", from.has_pitch_deg(), from.pitch_deg()),
          .yaw_deg = in.Angle("yaw_deg", from.has_yaw_deg(), from.yaw_deg())};
}

uc::Imu Read(Reader& in, const v1::TelemetryImu& from) {
  return {.acceleration_m_s2 = in.Within(
              "acceleration_m_s2", from.has_acceleration_m_s2(),
              [&](Reader& axes) { return ReadFrd(axes, from.acceleration_m_s2(), kAny); }),
          .angular_velocity_rad_s = in.Within(
              "angular_velocity_rad_s", from.has_angular_velocity_rad_s(),
              [&](Reader& axes) { return ReadFrd(axes, from.angular_velocity_rad_s(), kRate); }),
          .magnetic_field_gauss = in.Within(
              "magnetic_field_gauss", from.has_magnetic_field_gauss(),
              [&](Reader& axes) { return ReadFrd(axes, from.magnetic_field_gauss(), kAny); }),
          .temperature_degc = in.InRange("temperature_degc", from.has_temperature_degc(),
                                         from.temperature_degc(), kTemperature)};
}

uc::Odometry Read(Reader& in, const v1::TelemetryOdometry& from) {
  return {
      .frame_id = in.Enum<uc::OdometryFrame>(from.frame_id()),
      .child_frame_id = in.Enum<uc::OdometryFrame>(from.child_frame_id()),
      .position_m = in.Within("position_m", from.has_position_m(),
                              [&](Reader& axes) { return ReadXyz(axes, from.position_m(), kAny); }),
      .q = in.Within("q", from.has_q(),
                     [&](Reader& parts) { return ReadQuaternion(parts, from.q()); }),
      .velocity_m_s =
          in.Within("velocity_m_s", from.has_velocity_m_s(),
                    [&](Reader& axes) { return ReadXyz(axes, from.velocity_m_s(), kSpeed); }),
      .angular_velocity_rad_s =
          in.Within("angular_velocity_rad_s", from.has_angular_velocity_rad_s(),
                    [&](Reader& axes) { return ReadRates(axes, from.angular_velocity_rad_s()); }),
      .pose_covariance = ReadCovariance(in, "pose_covariance", from.pose_covariance()),
      .velocity_covariance = ReadCovariance(in, "velocity_covariance", from.velocity_covariance())};
}

}  // namespace uplink::uncrew
