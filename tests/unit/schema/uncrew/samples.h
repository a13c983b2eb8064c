#pragma once

#include <array>
#include <string_view>

#include "schema/model/uncrew/types.h"

namespace uplink::uncrew::test {

/// A good request with every field, and how Robot.uncrew shows it.
struct Sample {
  model::uncrew::SampleType type;
  /// Without metadata, in protobuf's text format.
  std::string_view text;
  /// Without times.
  std::string_view json;
};

using Type = model::uncrew::SampleType;

inline constexpr auto kSamples = std::to_array<Sample>({
    {Type::kAltitude,
     R"(altitude { altitude_monotonic_m: 1 altitude_amsl_m: 2 altitude_local_m: 3
        altitude_relative_m: 4 altitude_terrain_m: 5 bottom_clearance_m: 6 })",
     R"({"altitudeMonotonicM":1,"altitudeAmslM":2,"altitudeLocalM":3,"altitudeRelativeM":4,
         "altitudeTerrainM":5,"bottomClearanceM":6})"},
    {Type::kArmed, R"(armed { is_armed: false })", R"({"isArmed":false})"},
    {Type::kBattery,
     R"(battery { id: 1 temperature_degc: 20 voltage_v: 22.5 current_battery_a: 7 remaining_percent: 78
        capacity_consumed_ah: 2 time_remaining_s: 900 battery_function: BATTERY_FUNCTION_ALL })",
     R"({"temperatureDegc":20,"voltageV":22.5,"currentBatteryA":7,"capacityConsumedAh":2,
         "remainingPercent":78,"timeRemainingS":900,"batteryFunction":"all"})"},
    {Type::kCameraMode, R"(camera_mode { camera_id: 2 mode: CAMERA_MODE_VIDEO })",
     R"({"mode":"video"})"},
    {Type::kConnectionEvent,
     R"(connection_event { kind: KIND_DISCONNECTED link: "winch" text: "no answer for 2 s" })",
     R"({"kind":"disconnected","link":"winch","text":"no answer for 2 s"})"},
    {Type::kCurrentMissionItem, R"(current_mission_item { current: 2 total: 5 mission_id: "m1" })",
     R"({"current":2,"total":5,"missionId":"m1"})"},
    {Type::kDistanceSensor,
     R"(distance_sensor { id: 3 minimum_distance_m: 0.5 maximum_distance_m: 40
        current_distance_m: 12 orientation { pitch_deg: -90 } })",
     R"({"minimumDistanceM":0.5,"maximumDistanceM":40,"currentDistanceM":12,
         "orientation":{"pitchDeg":-90}})"},
    {Type::kError, R"(error { code: "E7" text: "motor is hot" source: "esc" command_id: "c1" })",
     R"({"code":"E7","text":"motor is hot","source":"esc","commandId":"c1"})"},
    {Type::kFlightMode, R"(flight_mode { mode: FLIGHT_MODE_RETURN_TO_LAUNCH })",
     R"({"mode":"return_to_launch"})"},
    {Type::kGpsInfo, R"(gps_info { num_satellites: 14 fix_type: GPS_FIX_TYPE_FIX_3D })",
     R"({"numSatellites":14,"fixType":"fix_3d"})"},
    {Type::kGimbalControlStatus,
     R"(gimbal_control_status { gimbal_id: 1 control_mode: CONTROL_MODE_PRIMARY
        sysid_primary_control: 1 compid_primary_control: 2 sysid_secondary_control: 3
        compid_secondary_control: 4 })",
     R"({"controlMode":"primary","sysidPrimaryControl":1,"compidPrimaryControl":2,
         "sysidSecondaryControl":3,"compidSecondaryControl":4})"},
    {Type::kHeading, R"(heading { heading_deg: -90 })", R"({"headingDeg":270})"},
    {Type::kHealth,
     R"(health { is_gyrometer_calibration_ok: true is_accelerometer_calibration_ok: true
        is_magnetometer_calibration_ok: true is_local_position_ok: true is_global_position_ok: true
        is_home_position_ok: false is_armable: false })",
     R"({"isGyrometerCalibrationOk":true,"isAccelerometerCalibrationOk":true,
         "isMagnetometerCalibrationOk":true,"isLocalPositionOk":true,"isGlobalPositionOk":true,
         "isHomePositionOk":false,"isArmable":false})"},
    {Type::kImu,
     R"(imu { acceleration_m_s2 { forward: 1 right: 2 down: 3 }
        angular_velocity_rad_s { forward: 4 right: 5 down: 6 }
        magnetic_field_gauss { forward: 7 right: 8 down: 9 } temperature_degc: 30 })",
     R"({"accelerationMS2":{"forward":1,"right":2,"down":3},
         "angularVelocityRadS":{"forward":4,"right":5,"down":6},
         "magneticFieldGauss":{"forward":7,"right":8,"down":9},"temperatureDegc":30})"},
    {Type::kOdometry,
     R"(odometry { frame_id: FRAME_BODY_NED child_frame_id: FRAME_ESTIM_NED
        position_m { x: 1 y: 2 z: 3 } q { w: 1 x: 0 y: 0 z: 0 } velocity_m_s { x: 4 y: 5 z: 6 }
        angular_velocity_rad_s { roll: 7 pitch: 8 yaw: 9 }
        pose_covariance { covariance_matrix: [1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21] }
        velocity_covariance { covariance_matrix: [nan,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0] } })",
     R"({"frameId":"body_ned","childFrameId":"estim_ned","positionM":{"x":1,"y":2,"z":3},
         "q":{"w":1,"x":0,"y":0,"z":0},"velocityMS":{"x":4,"y":5,"z":6},
         "angularVelocityRadS":{"roll":7,"pitch":8,"yaw":9},
         "poseCovariance":[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21]})"},
    {Type::kPoseEuler, R"(pose_euler { roll_deg: 180 pitch_deg: -180 yaw_deg: 270 })",
     R"({"rollDeg":180,"pitchDeg":180,"yawDeg":-90})"},
    {Type::kPosition,
     R"(position { latitude_deg: 47.5 longitude_deg: 8.5 absolute_altitude_m: 500
        relative_altitude_m: 60 })",
     R"({"latitudeDeg":47.5,"longitudeDeg":8.5,"absoluteAltitudeM":500,"relativeAltitudeM":60})"},
    {Type::kStatusText, R"(status_text { type: STATUS_TEXT_TYPE_NOTICE text: "takes off" })",
     R"({"type":"notice","text":"takes off"})"},
    {Type::kUncrewFlightMode, R"(uncrew_flight_mode { mode: "DELIVER" detail: "lowers the load" })",
     R"({"mode":"DELIVER","detail":"lowers the load"})"},
    {Type::kVelocityNed, R"(velocity_ned { north_m_s: 3 east_m_s: 4 down_m_s: -1 })",
     R"({"northMS":3,"eastMS":4,"downMS":-1})"},
    {Type::kVideoStreamSettings,
     R"(video_stream_settings { stream_id: 1 frame_rate_hz: 30 horizontal_resolution_pix: 1920
        vertical_resolution_pix: 1080 bit_rate_b_s: 4000000 rotation_deg: 450
        uri: "rtsp://root:secret@10.0.0.2:554/live" horizontal_fov_deg: 84 })",
     R"({"frameRateHz":30,"horizontalResolutionPix":1920,"verticalResolutionPix":1080,
         "bitRateBS":4000000,"rotationDeg":90,"uri":"rtsp://10.0.0.2:554/live",
         "horizontalFovDeg":84})"},
    {Type::kWinchReelStatus,
     R"(winch_reel_status { instance: 1 state: "reels in" line_remaining_m: 12 })",
     R"({"state":"reels in","lineRemainingM":12})"},
    {Type::kWinchStatus,
     R"(winch_status { instance: 1 line_length_m: 8 speed_m_s: -0.5 tension_kg: 2 voltage_v: 24
        current_a: 3 temperature_c: 35 status_flags { healthy: true retracting: true } })",
     R"({"lineLengthM":8,"speedMS":-0.5,"tensionKg":2,"voltageV":24,"currentA":3,"temperatureC":35,
         "statusFlags":{"healthy":true,"fullyRetracted":false,"moving":false,"clutchEngaged":false,
         "locked":false,"dropping":false,"arresting":false,"groundSense":false,"retracting":true,
         "redeliver":false,"abandonLine":false,"locking":false,"loadLine":false,
         "loadPayload":false}})"},
    {Type::kAlerts,
     R"(alerts { alerts { raised_at_unix_us: 5000 reaction { none {} }
          battery { battery_id: 2 condition: "cell low" } }
        alerts { alert_id: "low" text: "20 % left" reaction { rtl {} }
          battery_percentage { battery_id: 2 remaining_percent: 20 threshold_percent: 25 } }
        alerts { flight_termination { cause: "parachute" } } })",
     R"({"battery/2":{"alertId":"battery/2","kind":"battery","raisedAtUs":5000,"reaction":"none",
           "batteryId":2,"condition":"cell low"},
         "low":{"alertId":"low","kind":"battery_percentage","text":"20 % left",
           "reaction":"return_to_launch","batteryId":2,"remainingPercent":20,"thresholdPercent":25},
         "flight_termination":{"alertId":"flight_termination","kind":"flight_termination","cause":"parachute"}})"},
    {Type::kOperatorRequests,
     R"(operator_action_requests {
          requests { request_id: "r1" requested_at_unix_us: 7000 text: "ready?"
            confirm_delivery_ready {} }
          requests { request_id: "r2" confirm_delivery_complete {} } })",
     R"({"r1":{"requestId":"r1","kind":"confirm_delivery_ready","requestedAtUs":7000,
           "text":"ready?"},
         "r2":{"requestId":"r2","kind":"confirm_delivery_complete"}})"},
    {Type::kCommandResult,
     R"(command_id: "c1" status { state: STATE_FAILED code: "E7" text: "too windy" })",
     R"({"commandId":"c1","state":"failed","code":"E7","text":"too windy"})"},
});

static_assert(kSamples.size() == model::uncrew::kTypeRows.size());

}  // namespace uplink::uncrew::test
