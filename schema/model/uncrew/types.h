#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

/// The types of what a drone publishes, one row each, in the order of their numbers from 1:
/// TYPE(Type, Method, member, name, kind, parts_max).
///
///   Type       the enumerator, and the struct of the model
///   Method     of the contract's AvatarService; its request is Method##Request
///   member     of that request, which holds the sample; begins the path of a field
///   name       in `Robot.uncrew`
///   kind       of SampleKind
///   parts_max  how many of it a drone has at most, each by its key; 1: it has no key
///
/// Stores keep the numbers: a new type goes to the end, and is a row here, a struct, its fields
/// (fields.h) and its rules (schema/uncrew).
#define UPLINK_UNCREW_TYPES(TYPE)                                                                 \
  TYPE(Altitude, PublishAltitude, altitude, "altitude", kLive, 1)                                 \
  TYPE(Armed, PublishArmed, armed, "armed", kDurableOnChange, 1)                                  \
  TYPE(Battery, PublishBattery, battery, "battery", kLive, 8)                                     \
  TYPE(CameraMode, PublishCameraMode, camera_mode, "cameraMode", kLive, 8)                        \
  TYPE(ConnectionEvent, PublishConnectionEvent, connection_event, "connectionEvent", kDurable, 1) \
  TYPE(CurrentMissionItem, PublishCurrentMissionItem, current_mission_item, "currentMissionItem", \
       kDurableOnChange, 1)                                                                       \
  TYPE(DistanceSensor, PublishDistanceSensor, distance_sensor, "distanceSensor", kLive, 16)       \
  TYPE(Error, PublishError, error, "error", kDurable, 1)                                          \
  TYPE(FlightMode, PublishFlightMode, flight_mode, "flightMode", kDurableOnChange, 1)             \
  TYPE(GpsInfo, PublishGPSInfo, gps_info, "gpsInfo", kLive, 1)                                    \
  TYPE(GimbalControlStatus, PublishGimbalControlStatus, gimbal_control_status,                    \
       "gimbalControlStatus", kLive, 4)                                                           \
  TYPE(Heading, PublishHeading, heading, "heading", kLive, 1)                                     \
  TYPE(Health, PublishHealth, health, "health", kLive, 1)                                         \
  TYPE(Imu, PublishImu, imu, "imu", kLive, 1)                                                     \
  TYPE(Odometry, PublishOdometry, odometry, "odometry", kLive, 1)                                 \
  TYPE(PoseEuler, PublishPoseEuler, pose_euler, "poseEuler", kLive, 1)                            \
  TYPE(Position, PublishPosition, position, "position", kLive, 1)                                 \
  TYPE(StatusText, PublishStatusText, status_text, "statusText", kDurable, 1)                     \
  TYPE(UncrewFlightMode, PublishUncrewFlightMode, uncrew_flight_mode, "uncrewFlightMode",         \
       kDurableOnChange, 1)                                                                       \
  TYPE(VelocityNed, PublishVelocityNed, velocity_ned, "velocityNed", kLive, 1)                    \
  TYPE(VideoStreamSettings, PublishVideoStreamSettings, video_stream_settings,                    \
       "videoStreamSettings", kLive, 8)                                                           \
  TYPE(WinchReelStatus, PublishWinchReelStatus, winch_reel_status, "winchReelStatus", kLive, 8)   \
  TYPE(WinchStatus, PublishWinchStatus, winch_status, "winchStatus", kLive, 8)                    \
  TYPE(Alerts, PublishAlert, alerts, "alerts", kDurable, 1)                                       \
  TYPE(OperatorRequests, PublishOperatorActionRequests, operator_action_requests,                 \
       "operatorRequests", kDurable, 1)                                                           \
  TYPE(CommandResult, PublishUAVCommandResult, status, "commandResult", kDurable, 1)

namespace uplink::model::uncrew {

/// How a sample is settled: a live one when it is applied, a durable one when it is committed.
enum class SampleKind : std::uint8_t {
  kLive,
  kDurable,
  /// Durable if it says something else than the stored sample before it, else live.
  kDurableOnChange,
};

enum class SampleType : std::uint8_t {
  /// In stores only, for samples that were rejected: they are known again like those of a durable
  /// type.
  kRejected = 0,
#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max) k##Type,
  UPLINK_UNCREW_TYPES(UPLINK_TYPE)
#undef UPLINK_TYPE
};

/// One type. A value; its texts live for ever.
struct TypeRow {
  SampleType type;
  /// `PublishBattery`.
  std::string_view method;
  /// `battery`: for paths.
  std::string_view member;
  /// `gpsInfo`: in `Robot.uncrew`.
  std::string_view name;
  SampleKind kind;
  /// 1: it has no key.
  std::size_t parts_max;

  /// `gps_info`: of metrics.
  [[nodiscard]] constexpr std::string_view label() const {
    return type == SampleType::kCommandResult ? "command_result" : member;
  }
};

/// A row per type but kRejected, in their order.
inline constexpr auto kTypeRows = std::to_array<TypeRow>({
#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max) \
  {SampleType::k##Type, #Method, #member, name, SampleKind::kind, parts_max},
    UPLINK_UNCREW_TYPES(UPLINK_TYPE)
#undef UPLINK_TYPE
});

/// `type` is not kRejected.
[[nodiscard]] constexpr const TypeRow& RowOf(SampleType type) {
  return kTypeRows[static_cast<std::size_t>(type) - 1];
}

/// The type that a method of the contract publishes, or nothing.
[[nodiscard]] constexpr std::optional<SampleType> TypeOfMethod(std::string_view method) {
  for (const TypeRow& row : kTypeRows) {
    if (row.method == method) return row.type;
  }
  return std::nullopt;
}

static_assert(RowOf(SampleType::kCommandResult).type == SampleType::kCommandResult &&
              static_cast<std::size_t>(SampleType::kCommandResult) == kTypeRows.size());

}  // namespace uplink::model::uncrew
