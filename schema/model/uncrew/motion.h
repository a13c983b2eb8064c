#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "schema/model/enum_text.h"

/// Where a drone is and how it moves. What is absent is not known; what is there is finite. Units
/// and axes are the contract's (proto/uncrew/v1/avatar.proto).
namespace uplink::model::uncrew {

/// Six heights in metres, none of them above the ellipsoid. A value.
struct Altitude {
  std::optional<float> altitude_monotonic_m;
  std::optional<float> altitude_amsl_m;
  std::optional<float> altitude_local_m;
  std::optional<float> altitude_relative_m;
  std::optional<float> altitude_terrain_m;
  std::optional<float> bottom_clearance_m;

  friend bool operator==(const Altitude&, const Altitude&) = default;
};

/// WGS 84. A value.
struct Position {
  /// Both or neither.
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  /// Above mean sea level.
  std::optional<float> absolute_altitude_m;
  /// Above the place of take-off.
  std::optional<float> relative_altitude_m;

  friend bool operator==(const Position&, const Position&) = default;
};

/// A value.
struct VelocityNed {
  std::optional<float> north_m_s;
  std::optional<float> east_m_s;
  std::optional<float> down_m_s;

  friend bool operator==(const VelocityNed&, const VelocityNed&) = default;
};

/// A value.
struct Heading {
  /// From 0 to below 360, clockwise from north.
  std::optional<double> heading_deg;

  friend bool operator==(const Heading&, const Heading&) = default;
};

/// Angles above -180 and up to 180. A value.
struct PoseEuler {
  std::optional<float> roll_deg;
  std::optional<float> pitch_deg;
  std::optional<float> yaw_deg;

  friend bool operator==(const PoseEuler&, const PoseEuler&) = default;
};

/// In the body's frame. A value.
struct FrdVector {
  std::optional<float> forward;
  std::optional<float> right;
  std::optional<float> down;

  friend bool operator==(const FrdVector&, const FrdVector&) = default;
};

/// A value.
struct Imu {
  std::optional<FrdVector> acceleration_m_s2;
  std::optional<FrdVector> angular_velocity_rad_s;
  std::optional<FrdVector> magnetic_field_gauss;
  std::optional<float> temperature_degc;

  friend bool operator==(const Imu&, const Imu&) = default;
};

/// A value.
struct Xyz {
  std::optional<float> x;
  std::optional<float> y;
  std::optional<float> z;

  friend bool operator==(const Xyz&, const Xyz&) = default;
};

/// As it was sent: its length need not be 1. A value.
struct Quaternion {
  std::optional<float> w;
  std::optional<float> x;
  std::optional<float> y;
  std::optional<float> z;

  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

/// A value.
struct AngularVelocity {
  std::optional<float> roll;
  std::optional<float> pitch;
  std::optional<float> yaw;

  friend bool operator==(const AngularVelocity&, const AngularVelocity&) = default;
};

/// A frame of reference.
enum class OdometryFrame : std::int32_t {};

/// A value.
struct Odometry {
  OdometryFrame frame_id{};
  OdometryFrame child_frame_id{};
  std::optional<Xyz> position_m;
  std::optional<Quaternion> q;
  std::optional<Xyz> velocity_m_s;
  std::optional<AngularVelocity> angular_velocity_rad_s;
  /// 21 values each, or none.
  std::vector<float> pose_covariance;
  std::vector<float> velocity_covariance;

  friend bool operator==(const Odometry&, const Odometry&) = default;
};

}  // namespace uplink::model::uncrew

namespace uplink::model {

template <>
inline constexpr auto kEnumNames<uncrew::OdometryFrame> =
    std::to_array<std::string_view>({"undefined", "", "", "", "", "", "", "", "body_ned", "", "",
                                     "", "", "", "", "", "vision_ned", "", "estim_ned"});

}  // namespace uplink::model
