#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/model/enum_text.h"
#include "schema/model/uncrew/motion.h"

/// What a drone carries, and how it does. What is absent, or an empty text, is not known. Units are
/// the contract's; `key` is the contract's id, by which a drone has several.
namespace uplink::model::uncrew {

enum class BatteryFunction : std::int32_t {};

/// A value.
struct Battery {
  /// `id`.
  std::int64_t key = 0;
  std::optional<float> temperature_degc;
  std::optional<float> voltage_v;
  /// Positive: discharges.
  std::optional<float> current_battery_a;
  std::optional<float> capacity_consumed_ah;
  /// 0 to 100.
  std::optional<float> remaining_percent;
  std::optional<float> time_remaining_s;
  BatteryFunction battery_function{};

  friend bool operator==(const Battery&, const Battery&) = default;
};

enum class CameraModeKind : std::int32_t {};

/// A value.
struct CameraMode {
  /// `camera_id`.
  std::int64_t key = 0;
  CameraModeKind mode{};

  friend bool operator==(const CameraMode&, const CameraMode&) = default;
};

/// Metres. A value.
struct DistanceSensor {
  /// `id`.
  std::int64_t key = 0;
  std::optional<float> minimum_distance_m;
  std::optional<float> maximum_distance_m;
  std::optional<float> current_distance_m;
  /// Where it looks, against the drone's nose.
  std::optional<PoseEuler> orientation;

  friend bool operator==(const DistanceSensor&, const DistanceSensor&) = default;
};

enum class GimbalControlMode : std::int32_t {};

/// Who controls a gimbal: MAVLink's ids, 0 for none. A value.
struct GimbalControlStatus {
  /// `gimbal_id`.
  std::int64_t key = 0;
  GimbalControlMode control_mode{};
  std::int32_t sysid_primary_control = 0;
  std::int32_t compid_primary_control = 0;
  std::int32_t sysid_secondary_control = 0;
  std::int32_t compid_secondary_control = 0;

  friend bool operator==(const GimbalControlStatus&, const GimbalControlStatus&) = default;
};

enum class GpsFix : std::int32_t {};

/// A value.
struct GpsInfo {
  /// 0 to 255.
  std::optional<std::int32_t> num_satellites;
  /// Always there: that it has no GPS is something to know.
  std::optional<GpsFix> fix_type;

  friend bool operator==(const GpsInfo&, const GpsInfo&) = default;
};

/// A value.
struct Health {
  std::optional<bool> is_gyrometer_calibration_ok;
  std::optional<bool> is_accelerometer_calibration_ok;
  std::optional<bool> is_magnetometer_calibration_ok;
  std::optional<bool> is_local_position_ok;
  std::optional<bool> is_global_position_ok;
  std::optional<bool> is_home_position_ok;
  std::optional<bool> is_armable;

  friend bool operator==(const Health&, const Health&) = default;
};

/// A value.
struct VideoStreamSettings {
  /// `stream_id`.
  std::int64_t key = 0;
  std::optional<float> frame_rate_hz;
  std::uint32_t horizontal_resolution_pix = 0;
  std::uint32_t vertical_resolution_pix = 0;
  std::uint32_t bit_rate_b_s = 0;
  /// 0 to 359, clockwise.
  std::uint32_t rotation_deg = 0;
  /// Without a user's name and password.
  std::string uri;
  std::optional<float> horizontal_fov_deg;

  friend bool operator==(const VideoStreamSettings&, const VideoStreamSettings&) = default;
};

/// A value.
struct WinchReelStatus {
  /// `instance`.
  std::int64_t key = 0;
  std::string state;
  std::optional<float> line_remaining_m;

  friend bool operator==(const WinchReelStatus&, const WinchReelStatus&) = default;
};

/// A value.
struct WinchStatusFlags {
  bool healthy = false;
  bool fully_retracted = false;
  bool moving = false;
  bool clutch_engaged = false;
  bool locked = false;
  bool dropping = false;
  bool arresting = false;
  bool ground_sense = false;
  bool retracting = false;
  bool redeliver = false;
  bool abandon_line = false;
  bool locking = false;
  bool load_line = false;
  bool load_payload = false;

  friend bool operator==(const WinchStatusFlags&, const WinchStatusFlags&) = default;
};

/// A value.
struct WinchStatus {
  /// `instance`.
  std::int64_t key = 0;
  /// Line that is out.
  std::optional<float> line_length_m;
  /// Positive: unwinds.
  std::optional<float> speed_m_s;
  std::optional<float> tension_kg;
  std::optional<float> voltage_v;
  std::optional<float> current_a;
  std::optional<std::int32_t> temperature_c;
  std::optional<WinchStatusFlags> status_flags;

  friend bool operator==(const WinchStatus&, const WinchStatus&) = default;
};

}  // namespace uplink::model::uncrew

namespace uplink::model {

template <>
inline constexpr auto kEnumNames<uncrew::BatteryFunction> =
    std::to_array<std::string_view>({"unknown", "all", "propulsion", "avionics", "payload"});
template <>
inline constexpr auto kEnumNames<uncrew::CameraModeKind> =
    std::to_array<std::string_view>({"unknown", "photo", "video"});
template <>
inline constexpr auto kEnumNames<uncrew::GimbalControlMode> =
    std::to_array<std::string_view>({"none", "primary", "secondary"});
template <>
inline constexpr auto kEnumNames<uncrew::GpsFix> = std::to_array<std::string_view>(
    {"no_gps", "no_fix", "fix_2d", "fix_3d", "fix_dgps", "rtk_float", "rtk_fixed"});

}  // namespace uplink::model
