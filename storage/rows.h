#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/ids.h"
#include "schema/model/message_source.h"
#include "schema/model/mission.h"
#include "schema/model/operator_request.h"
#include "schema/model/presence.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "schema/model/scope_update.h"
#include "schema/model/spatial.h"
#include "storage/connection.h"
#include "storage/identity.h"

// The rows of the lists that are read in pages (lists.h). Values.
namespace uplink::storage {

struct FaultRow {
  model::RobotId robot;
  model::Fault fault;
  SystemTime received_at;
  /// First raise since it was last clear; only in rows of the active set.
  std::optional<SystemTime> raised_at;
  /// When an operator acknowledged it since it was raised last; only in rows of the active set.
  std::optional<SystemTime> acknowledged_at{};
  std::string acknowledged_by{};
  std::string acknowledged_note{};
};

struct QuarantineRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq seq = 0;
  model::Rejection rejection;
  SystemTime received_at;
  std::string payload;
  std::uint64_t payload_bytes = 0;
  model::MessageSource source = model::MessageSource::kUplink;
  /// Empty if it came by the relay.
  std::string topic;
};

/// Rows of a robot's quarantine that went for its bound, for one reason.
struct DroppedRow {
  model::RejectReason reason = model::RejectReason::kMalformed;
  std::uint64_t count = 0;

  friend bool operator==(const DroppedRow&, const DroppedRow&) = default;
};

struct GapRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq first = 0;
  model::Seq last = 0;
  SystemTime seen_at;
};

struct EventRow {
  model::RobotId robot;
  /// The union member's name.
  std::string kind;
  /// What it holds: json::DetailText.
  std::string detail_json;
  /// The robot's clock, Unix milliseconds; 0 if unknown. So everywhere below.
  std::int64_t sampled_at_ms = 0;
  SystemTime received_at;
};

struct MessageRow {
  model::RobotId robot;
  model::Message message;
  SystemTime received_at;
};

/// An update of what is no robot. `robot` is what stands in a robot's place, with the fleet that
/// may see it.
struct ScopeUpdateRow {
  model::RobotId robot;
  model::ScopeUpdate update;
  SystemTime received_at;
};

/// Why the server closed a run that its robot had left open. The numbers stand in columns.
enum class RunClosed : std::uint8_t {
  kNot = 0,
  /// kOpenRunsPerRobotMax others were reported later.
  kForBound = 1,
  /// It was not reported for kOpenRunAgeMax.
  kForAge = 2,
};

/// One run of a mission: (robot, mission_id, run_id). Stands in lists by its first arrival, so that
/// a run that goes on keeps its place.
struct MissionRunRow {
  model::RobotId robot;
  std::string mission_id;
  std::string run_id;
  /// The last name that a report gave.
  std::string name;
  model::MissionStatus status = model::MissionStatus::kUnknown;
  /// The latest report: json::Text.
  std::string latest_json;
  SystemTime first_received_at;
  SystemTime last_received_at;
  /// Reports so far.
  std::uint64_t updates = 0;
  /// Nothing of the report is changed by that, and the next report undoes it.
  RunClosed closed = RunClosed::kNot;
  /// Unix milliseconds; 0 if it was not.
  std::int64_t closed_at_ms = 0;
};

/// One report of a run.
struct MissionReportRow {
  model::RobotId robot;
  std::string mission_id;
  std::string run_id;
  model::MissionStatus status = model::MissionStatus::kUnknown;
  std::string report_json;
  SystemTime received_at;
};

/// A request of a drone to its operator. Stands in lists by the arrival that opened it; one that is
/// opened again by the same id is another row.
struct OperatorRequestRow {
  model::RobotId robot;
  std::string request_id;
  model::OperatorRequestKind kind = model::OperatorRequestKind::kConfirmDeliveryReady;
  std::string text;
  /// Since when the drone waits, by its own clock, Unix milliseconds; 0 if unknown.
  std::int64_t requested_at_ms = 0;
  SystemTime opened_at;
  /// The arrival of what closed it, Unix milliseconds; 0: it is open.
  std::int64_t closed_at_ms = 0;
};

/// A shape that is there. Stands in lists by the arrival of the upsert that made its id present, so
/// that one that changes keeps its place.
struct ShapeRow {
  model::RobotId robot;
  model::AssetIdentity identity;
  model::ReportedLayerRole area_type = model::ReportedLayerRole::kCoverage;
  model::ScopeType scope = model::ScopeType::kRobot;
  /// GeoJSON: json::GeometryText.
  std::string geometry_json;
  /// Unix milliseconds; 0: never.
  std::int64_t expires_at_ms = 0;
  double min_z_m = 0;
  double max_z_m = 0;
  std::int32_t level_id = 0;
  /// Of the latest upsert.
  SystemTime received_at;
};

/// An object that is there; in lists as ShapeRow.
struct ObjectRow {
  model::RobotId robot;
  std::string id;
  std::string name;
  model::ObjectType object_type = model::ObjectType::kUnknown;
  model::ScopeType scope = model::ScopeType::kRobot;
  /// json::Text of the pose.
  std::string location_json;
  /// json::Text of the trajectory; empty if there is none.
  std::string trajectory_json;
  double radius_m = 0;
  std::int64_t sampled_at_ms = 0;
  /// With StoreRules.object_ttl applied; 0: never.
  std::int64_t expires_at_ms = 0;
  SystemTime received_at;
};

struct PresenceRow {
  model::RobotId robot;
  model::Presence presence = model::Presence::kUnknown;
  SystemTime at;
  /// PresenceItem::why.
  std::optional<model::ConnectionEnd> why{};
};

/// One connection of a robot, as ConnectionItem has it. Stands in lists by its beginning.
struct ConnectionRow {
  model::RobotId robot;
  ConnectionId id{};
  model::MessageSource source = model::MessageSource::kUplink;
  SystemTime began_at;
  ProcessId process{};
  std::string server;
  std::string address;
  std::string gateway;
  std::string agent_version;
  CertificateFacts certificate;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::uint32_t takeovers = 0;
  std::int64_t held_back_ms = 0;
  std::string held_back_why;
  /// Both, or neither: it is open.
  std::optional<SystemTime> ended_at;
  std::optional<model::ConnectionEnd> why;
  // Of an end alone.
  std::string code;
  std::string detail;
};

}  // namespace uplink::storage
