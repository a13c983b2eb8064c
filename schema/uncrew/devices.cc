#include <cstdint>
#include <optional>

#include "schema/rules/uri.h"
#include "schema/uncrew/families.h"
#include "schema/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using schema::Bounds;

constexpr Bounds kTemperature = {schema::kTemperatureCMin, schema::kTemperatureCMax};
constexpr Bounds kVolts = {0, kVoltsMax};
constexpr Bounds kAmperes = {-kAmperesMax, kAmperesMax};
constexpr Bounds kSpeed = {-schema::kLinearMpsMax, schema::kLinearMpsMax};
constexpr Bounds kSatellites = {0, kSatellitesMax};
constexpr std::uint32_t kTurnDeg = 360;

std::optional<bool> BoolOf(bool there, bool value) {
  return there ? std::optional(value) : std::nullopt;
}

uc::WinchStatusFlags FlagsOf(const v1::WinchStatusFlags& from) {
  return {.healthy = from.healthy(),
          .fully_retracted = from.fully_retracted(),
          .moving = from.moving(),
          .clutch_engaged = from.clutch_engaged(),
          .locked = from.locked(),
          .dropping = from.dropping(),
          .arresting = from.arresting(),
          .ground_sense = from.ground_sense(),
          .retracting = from.retracting(),
          .redeliver = from.redeliver(),
          .abandon_line = from.abandon_line(),
          .locking = from.locking(),
          .load_line = from.load_line(),
          .load_payload = from.load_payload()};
}

}  // namespace

uc::Battery Read(Reader& in, const v1::TelemetryBattery& from) {
  return {.key = from.id(),
          .temperature_degc = in.InRange("temperature_degc", from.has_temperature_degc(),
                                         from.temperature_degc(), kTemperature),
          .voltage_v = in.InRange("voltage_v", from.has_voltage_v(), from.voltage_v(), kVolts),
          .current_battery_a = in.InRange("current_battery_a", from.has_current_battery_a(),
                                          from.current_battery_a(), kAmperes),
          .capacity_consumed_ah = in.Finite("capacity_consumed_ah", from.has_capacity_consumed_ah(),
                                            from.capacity_consumed_ah()),
          .remaining_percent = in.Percent("remaining_percent", from.has_remaining_percent(),
                                          from.remaining_percent()),
          .time_remaining_s = in.NotNegative("time_remaining_s", from.has_time_remaining_s(),
                                             from.time_remaining_s()),
          .battery_function = in.Enum<uc::BatteryFunction>(from.battery_function())};
}

uc::CameraMode Read(Reader& in, const v1::TelemetryCameraMode& from) {
  return {.key = from.camera_id(), .mode = in.Enum<uc::CameraModeKind>(from.mode())};
}

uc::DistanceSensor Read(Reader& in, const v1::TelemetryDistanceSensor& from) {
  return {.key = from.id(),
          .minimum_distance_m = in.NotNegative("minimum_distance_m", from.has_minimum_distance_m(),
                                               from.minimum_distance_m()),
          .maximum_distance_m = in.NotNegative("maximum_distance_m", from.has_maximum_distance_m(),
                                               from.maximum_distance_m()),
          .current_distance_m = in.NotNegative("current_distance_m", from.has_current_distance_m(),
                                               from.current_distance_m()),
          .orientation = in.Within("orientation", from.has_orientation(), [&](Reader& angles) {
            return Read(angles, from.orientation());
          })};
}

uc::GimbalControlStatus Read(Reader& in, const v1::TelemetryGimbalControlStatus& from) {
  return {.key = from.gimbal_id(),
          .control_mode = in.Enum<uc::GimbalControlMode>(from.control_mode()),
          .sysid_primary_control = from.sysid_primary_control(),
          .compid_primary_control = from.compid_primary_control(),
          .sysid_secondary_control = from.sysid_secondary_control(),
          .compid_secondary_control = from.compid_secondary_control()};
}

uc::GpsInfo Read(Reader& in, const v1::TelemetryGPSInfo& from) {
  return {.num_satellites = in.InRange("num_satellites", from.has_num_satellites(),
                                       from.num_satellites(), kSatellites),
          .fix_type = in.Enum<uc::GpsFix>(from.fix_type())};
}

uc::Health Read(Reader& /*in*/, const v1::TelemetryHealth& from) {
  return {
      .is_gyrometer_calibration_ok =
          BoolOf(from.has_is_gyrometer_calibration_ok(), from.is_gyrometer_calibration_ok()),
      .is_accelerometer_calibration_ok = BoolOf(from.has_is_accelerometer_calibration_ok(),
                                                from.is_accelerometer_calibration_ok()),
      .is_magnetometer_calibration_ok =
          BoolOf(from.has_is_magnetometer_calibration_ok(), from.is_magnetometer_calibration_ok()),
      .is_local_position_ok = BoolOf(from.has_is_local_position_ok(), from.is_local_position_ok()),
      .is_global_position_ok =
          BoolOf(from.has_is_global_position_ok(), from.is_global_position_ok()),
      .is_home_position_ok = BoolOf(from.has_is_home_position_ok(), from.is_home_position_ok()),
      .is_armable = BoolOf(from.has_is_armable(), from.is_armable())};
}

uc::VideoStreamSettings Read(Reader& in, const v1::TelemetryVideoStreamSettings& from) {
  return {
      .key = from.stream_id(),
      .frame_rate_hz = in.Finite("frame_rate_hz", from.has_frame_rate_hz(), from.frame_rate_hz()),
      .horizontal_resolution_pix = from.horizontal_resolution_pix(),
      .vertical_resolution_pix = from.vertical_resolution_pix(),
      .bit_rate_b_s = from.bit_rate_b_s(),
      .rotation_deg = from.rotation_deg() % kTurnDeg,
      .uri = schema::WithoutCredentials(in.Text("uri", from.uri(), schema::kDescriptionBytesMax)),
      .horizontal_fov_deg = in.Finite("horizontal_fov_deg", from.has_horizontal_fov_deg(),
                                      from.horizontal_fov_deg())};
}

uc::WinchReelStatus Read(Reader& in, const v1::TelemetryWinchReelStatus& from) {
  return {.key = from.instance(),
          .state = in.Text("state", from.state(), schema::kNameBytesMax),
          .line_remaining_m = in.NotNegative("line_remaining_m", from.has_line_remaining_m(),
                                             from.line_remaining_m())};
}

uc::WinchStatus Read(Reader& in, const v1::TelemetryWinchStatus& from) {
  return {.key = from.instance(),
          .line_length_m =
              in.NotNegative("line_length_m", from.has_line_length_m(), from.line_length_m()),
          .speed_m_s = in.InRange("speed_m_s", from.has_speed_m_s(), from.speed_m_s(), kSpeed),
          .tension_kg = in.NotNegative("tension_kg", from.has_tension_kg(), from.tension_kg()),
          .voltage_v = in.InRange("voltage_v", from.has_voltage_v(), from.voltage_v(), kVolts),
          .current_a = in.InRange("current_a", from.has_current_a(), from.current_a(), kAmperes),
          .temperature_c = in.InRange("temperature_c", from.has_temperature_c(),
                                      from.temperature_c(), kTemperature),
          .status_flags =
              from.has_status_flags() ? std::optional(FlagsOf(from.status_flags())) : std::nullopt};
}

}  // namespace uplink::uncrew
