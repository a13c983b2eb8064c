#pragma once

#include "schema/model/uncrew/value.h"
#include "schema/uncrew/reader.h"
#include "uncrew/v1/avatar.pb.h"

/// One function per type, in the file of its family as in the model: the contract's message to the
/// model, judged on the way. What is wrong goes to the reader's violations, and what is returned
/// then of a message that is rejected is not used.
namespace uplink::uncrew {

namespace v1 = ::uncrew::v1;

// motion.cc
[[nodiscard]] model::uncrew::Altitude Read(Reader& in, const v1::TelemetryAltitude& from);
[[nodiscard]] model::uncrew::Position Read(Reader& in, const v1::TelemetryPosition& from);
[[nodiscard]] model::uncrew::VelocityNed Read(Reader& in, const v1::TelemetryVelocityNed& from);
[[nodiscard]] model::uncrew::Heading Read(Reader& in, const v1::TelemetryHeading& from);
[[nodiscard]] model::uncrew::PoseEuler Read(Reader& in, const v1::TelemetryPoseEuler& from);
[[nodiscard]] model::uncrew::Imu Read(Reader& in, const v1::TelemetryImu& from);
[[nodiscard]] model::uncrew::Odometry Read(Reader& in, const v1::TelemetryOdometry& from);

// devices.cc
[[nodiscard]] model::uncrew::Battery Read(Reader& in, const v1::TelemetryBattery& from);
[[nodiscard]] model::uncrew::CameraMode Read(Reader& in, const v1::TelemetryCameraMode& from);
[[nodiscard]] model::uncrew::DistanceSensor Read(Reader& in,
                                                 const v1::TelemetryDistanceSensor& from);
[[nodiscard]] model::uncrew::GimbalControlStatus Read(Reader& in,
                                                      const v1::TelemetryGimbalControlStatus& from);
[[nodiscard]] model::uncrew::GpsInfo Read(Reader& in, const v1::TelemetryGPSInfo& from);
[[nodiscard]] model::uncrew::Health Read(Reader& in, const v1::TelemetryHealth& from);
[[nodiscard]] model::uncrew::VideoStreamSettings Read(Reader& in,
                                                      const v1::TelemetryVideoStreamSettings& from);
[[nodiscard]] model::uncrew::WinchReelStatus Read(Reader& in,
                                                  const v1::TelemetryWinchReelStatus& from);
[[nodiscard]] model::uncrew::WinchStatus Read(Reader& in, const v1::TelemetryWinchStatus& from);

// modes.cc
[[nodiscard]] model::uncrew::Armed Read(Reader& in, const v1::TelemetryArmed& from);
[[nodiscard]] model::uncrew::FlightMode Read(Reader& in, const v1::TelemetryFlightMode& from);
[[nodiscard]] model::uncrew::UncrewFlightMode Read(Reader& in,
                                                   const v1::TelemetryUncrewFlightMode& from);
[[nodiscard]] model::uncrew::CurrentMissionItem Read(Reader& in,
                                                     const v1::TelemetryCurrentMissionItem& from);

// reports.cc
[[nodiscard]] model::uncrew::StatusText Read(Reader& in, const v1::TelemetryStatusText& from);
[[nodiscard]] model::uncrew::Error Read(Reader& in, const v1::TelemetryError& from);
[[nodiscard]] model::uncrew::ConnectionEvent Read(Reader& in,
                                                  const v1::TelemetryConnectionEvent& from);
/// The command is a field of its own, beside `from`.
[[nodiscard]] model::uncrew::CommandResult Read(Reader& in, const v1::ProcedureStatus& from);
[[nodiscard]] model::uncrew::Alerts Read(Reader& in, const v1::Alerts& from);
[[nodiscard]] model::uncrew::OperatorRequests Read(Reader& in,
                                                   const v1::OperatorActionRequests& from);

}  // namespace uplink::uncrew
