#pragma once

#include <string_view>
#include <tuple>
#include <type_traits>

#include "schema/model/uncrew/devices.h"
#include "schema/model/uncrew/modes.h"
#include "schema/model/uncrew/motion.h"
#include "schema/model/uncrew/reports.h"

namespace uplink::model::uncrew {

/// One field of a struct. A value; its name lives for ever.
template <typename Owner, typename T>
struct Field {
  /// As readers see it; the contract's with capitals in place of underscores.
  std::string_view name;
  T Owner::*member;
};
template <typename Owner, typename T>
Field(std::string_view, T Owner::*) -> Field<Owner, T>;

/// The fields of a struct but `key`. JSON, the count of memory and the question whether anything
/// is known go by them.
template <typename Struct>
inline constexpr std::tuple<> kFields{};

/// A struct whose fields are listed.
template <typename Struct>
concept Listed = (std::tuple_size_v<std::remove_cvref_t<decltype(kFields<Struct>)>> > 0);

template <>
inline constexpr auto kFields<Altitude> =
    std::tuple(Field{"altitudeMonotonicM", &Altitude::altitude_monotonic_m},
               Field{"altitudeAmslM", &Altitude::altitude_amsl_m},
               Field{"altitudeLocalM", &Altitude::altitude_local_m},
               Field{"altitudeRelativeM", &Altitude::altitude_relative_m},
               Field{"altitudeTerrainM", &Altitude::altitude_terrain_m},
               Field{"bottomClearanceM", &Altitude::bottom_clearance_m});
template <>
inline constexpr auto kFields<Position> = std::tuple(
    Field{"latitudeDeg", &Position::latitude_deg}, Field{"longitudeDeg", &Position::longitude_deg},
    Field{"absoluteAltitudeM", &Position::absolute_altitude_m},
    Field{"relativeAltitudeM", &Position::relative_altitude_m});
template <>
inline constexpr auto kFields<VelocityNed> = std::tuple(Field{"northMS", &VelocityNed::north_m_s},
                                                        Field{"eastMS", &VelocityNed::east_m_s},
                                                        Field{"downMS", &VelocityNed::down_m_s});
template <>
inline constexpr auto kFields<Heading> = std::tuple(Field{"headingDeg", &Heading::heading_deg});
template <>
inline constexpr auto kFields<PoseEuler> = std::tuple(Field{"rollDeg", &PoseEuler::roll_deg},
                                                      Field{"pitchDeg", &PoseEuler::pitch_deg},
                                                      Field{"yawDeg", &PoseEuler::yaw_deg});
template <>
inline constexpr auto kFields<FrdVector> = std::tuple(Field{"forward", &FrdVector::forward},
                                                      Field{"right", &FrdVector::right},
                                                      Field{"down", &FrdVector::down});
template <>
inline constexpr auto kFields<Imu> =
    std::tuple(Field{"accelerationMS2", &Imu::acceleration_m_s2},
               Field{"angularVelocityRadS", &Imu::angular_velocity_rad_s},
               Field{"magneticFieldGauss", &Imu::magnetic_field_gauss},
               Field{"temperatureDegc", &Imu::temperature_degc});
template <>
inline constexpr auto kFields<Xyz> = std::tuple(Field{"x", &Xyz::x}, Field{"y", &Xyz::y},
                                                Field{"z", &Xyz::z});
template <>
inline constexpr auto kFields<Quaternion> = std::tuple(Field{"w", &Quaternion::w},
                                                       Field{"x", &Quaternion::x},
                                                       Field{"y", &Quaternion::y},
                                                       Field{"z", &Quaternion::z});
template <>
inline constexpr auto kFields<AngularVelocity> = std::tuple(Field{"roll", &AngularVelocity::roll},
                                                            Field{"pitch", &AngularVelocity::pitch},
                                                            Field{"yaw", &AngularVelocity::yaw});
template <>
inline constexpr auto kFields<Odometry> = std::tuple(
    Field{"frameId", &Odometry::frame_id}, Field{"childFrameId", &Odometry::child_frame_id},
    Field{"positionM", &Odometry::position_m}, Field{"q", &Odometry::q},
    Field{"velocityMS", &Odometry::velocity_m_s},
    Field{"angularVelocityRadS", &Odometry::angular_velocity_rad_s},
    Field{"poseCovariance", &Odometry::pose_covariance},
    Field{"velocityCovariance", &Odometry::velocity_covariance});

template <>
inline constexpr auto kFields<Battery> = std::tuple(
    Field{"temperatureDegc", &Battery::temperature_degc}, Field{"voltageV", &Battery::voltage_v},
    Field{"currentBatteryA", &Battery::current_battery_a},
    Field{"capacityConsumedAh", &Battery::capacity_consumed_ah},
    Field{"remainingPercent", &Battery::remaining_percent},
    Field{"timeRemainingS", &Battery::time_remaining_s},
    Field{"batteryFunction", &Battery::battery_function});
template <>
inline constexpr auto kFields<CameraMode> = std::tuple(Field{"mode", &CameraMode::mode});
template <>
inline constexpr auto kFields<DistanceSensor> =
    std::tuple(Field{"minimumDistanceM", &DistanceSensor::minimum_distance_m},
               Field{"maximumDistanceM", &DistanceSensor::maximum_distance_m},
               Field{"currentDistanceM", &DistanceSensor::current_distance_m},
               Field{"orientation", &DistanceSensor::orientation});
template <>
inline constexpr auto kFields<GimbalControlStatus> =
    std::tuple(Field{"controlMode", &GimbalControlStatus::control_mode},
               Field{"sysidPrimaryControl", &GimbalControlStatus::sysid_primary_control},
               Field{"compidPrimaryControl", &GimbalControlStatus::compid_primary_control},
               Field{"sysidSecondaryControl", &GimbalControlStatus::sysid_secondary_control},
               Field{"compidSecondaryControl", &GimbalControlStatus::compid_secondary_control});
template <>
inline constexpr auto kFields<GpsInfo> = std::tuple(Field{"numSatellites",
                                                          &GpsInfo::num_satellites},
                                                    Field{"fixType", &GpsInfo::fix_type});
template <>
inline constexpr auto kFields<Health> =
    std::tuple(Field{"isGyrometerCalibrationOk", &Health::is_gyrometer_calibration_ok},
               Field{"isAccelerometerCalibrationOk", &Health::is_accelerometer_calibration_ok},
               Field{"isMagnetometerCalibrationOk", &Health::is_magnetometer_calibration_ok},
               Field{"isLocalPositionOk", &Health::is_local_position_ok},
               Field{"isGlobalPositionOk", &Health::is_global_position_ok},
               Field{"isHomePositionOk", &Health::is_home_position_ok},
               Field{"isArmable", &Health::is_armable});
template <>
inline constexpr auto kFields<VideoStreamSettings> =
    std::tuple(Field{"frameRateHz", &VideoStreamSettings::frame_rate_hz},
               Field{"horizontalResolutionPix", &VideoStreamSettings::horizontal_resolution_pix},
               Field{"verticalResolutionPix", &VideoStreamSettings::vertical_resolution_pix},
               Field{"bitRateBS", &VideoStreamSettings::bit_rate_b_s},
               Field{"rotationDeg", &VideoStreamSettings::rotation_deg},
               Field{"uri", &VideoStreamSettings::uri},
               Field{"horizontalFovDeg", &VideoStreamSettings::horizontal_fov_deg});
template <>
inline constexpr auto kFields<WinchReelStatus> =
    std::tuple(Field{"state", &WinchReelStatus::state},
               Field{"lineRemainingM", &WinchReelStatus::line_remaining_m});
template <>
inline constexpr auto kFields<WinchStatusFlags> = std::tuple(
    Field{"healthy", &WinchStatusFlags::healthy},
    Field{"fullyRetracted", &WinchStatusFlags::fully_retracted},
    Field{"moving", &WinchStatusFlags::moving},
    Field{"clutchEngaged", &WinchStatusFlags::clutch_engaged},
    Field{"locked", &WinchStatusFlags::locked}, Field{"dropping", &WinchStatusFlags::dropping},
    Field{"arresting", &WinchStatusFlags::arresting},
    Field{"groundSense", &WinchStatusFlags::ground_sense},
    Field{"retracting", &WinchStatusFlags::retracting},
    Field{"redeliver", &WinchStatusFlags::redeliver},
    Field{"abandonLine", &WinchStatusFlags::abandon_line},
    Field{"locking", &WinchStatusFlags::locking}, Field{"loadLine", &WinchStatusFlags::load_line},
    Field{"loadPayload", &WinchStatusFlags::load_payload});
template <>
inline constexpr auto kFields<WinchStatus> = std::tuple(
    Field{"lineLengthM", &WinchStatus::line_length_m}, Field{"speedMS", &WinchStatus::speed_m_s},
    Field{"tensionKg", &WinchStatus::tension_kg}, Field{"voltageV", &WinchStatus::voltage_v},
    Field{"currentA", &WinchStatus::current_a}, Field{"temperatureC", &WinchStatus::temperature_c},
    Field{"statusFlags", &WinchStatus::status_flags});

template <>
inline constexpr auto kFields<Armed> = std::tuple(Field{"isArmed", &Armed::is_armed});
template <>
inline constexpr auto kFields<FlightMode> = std::tuple(Field{"mode", &FlightMode::mode});
template <>
inline constexpr auto kFields<UncrewFlightMode> =
    std::tuple(Field{"mode", &UncrewFlightMode::mode}, Field{"detail", &UncrewFlightMode::detail});
template <>
inline constexpr auto kFields<CurrentMissionItem> = std::tuple(
    Field{"current", &CurrentMissionItem::current}, Field{"total", &CurrentMissionItem::total},
    Field{"missionId", &CurrentMissionItem::mission_id});

template <>
inline constexpr auto kFields<StatusText> = std::tuple(Field{"type", &StatusText::type},
                                                       Field{"text", &StatusText::text});
template <>
inline constexpr auto kFields<Error> = std::tuple(Field{"code", &Error::code},
                                                  Field{"text", &Error::text},
                                                  Field{"source", &Error::source},
                                                  Field{"commandId", &Error::command_id});
template <>
inline constexpr auto kFields<ConnectionEvent> = std::tuple(Field{"kind", &ConnectionEvent::kind},
                                                            Field{"link", &ConnectionEvent::link},
                                                            Field{"text", &ConnectionEvent::text});
template <>
inline constexpr auto kFields<CommandResult> = std::tuple(
    Field{"commandId", &CommandResult::command_id}, Field{"state", &CommandResult::state},
    Field{"code", &CommandResult::code}, Field{"text", &CommandResult::text});
template <>
inline constexpr auto kFields<Alert> = std::tuple(
    Field{"alertId", &Alert::alert_id}, Field{"kind", &Alert::kind},
    Field{"raisedAtUs", &Alert::raised_at_us}, Field{"text", &Alert::text},
    Field{"reaction", &Alert::reaction}, Field{"batteryId", &Alert::battery_id},
    Field{"condition", &Alert::condition}, Field{"remainingPercent", &Alert::remaining_percent},
    Field{"thresholdPercent", &Alert::threshold_percent}, Field{"cause", &Alert::cause});
template <>
inline constexpr auto kFields<Alerts> = std::tuple(Field{"alerts", &Alerts::items});
template <>
inline constexpr auto kFields<OperatorActionRequest> =
    std::tuple(Field{"requestId", &OperatorActionRequest::request_id},
               Field{"kind", &OperatorActionRequest::kind},
               Field{"requestedAtUs", &OperatorActionRequest::requested_at_us},
               Field{"text", &OperatorActionRequest::text});
template <>
inline constexpr auto kFields<OperatorRequests> = std::tuple(Field{"operatorRequests",
                                                                   &OperatorRequests::items});

}  // namespace uplink::model::uncrew
