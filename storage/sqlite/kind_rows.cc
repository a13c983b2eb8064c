#include "storage/sqlite/kind_rows.h"

#include <string>

#include "storage/numbers.h"
#include "storage/sqlite/tables.h"
#include "storage/sqlite/values.h"

namespace uplink::storage::sqlite {
namespace {

std::string Text(const Rows& rows, int column) { return std::string(rows.Bytes(column)); }

model::RobotId RobotOf(const Rows& rows) {
  return {Text(rows, kRuriColumn), Text(rows, kFleetColumn)};
}

absl::StatusOr<model::SessionId> SessionOf(const Rows& rows) {
  const auto session = model::SessionId::FromBytes(rows.Bytes(kFirstOwnColumn));
  if (!session) return absl::InternalError("a session in the store is not 16 bytes");
  return *session;
}

}  // namespace

ListFilter FilterOf(const MissionsQuery& query, bool open) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    // A mission may be that of a whole fleet: where a robot is named, its index is the better one.
    filter.sql += query.rows.ruri.empty() ? " AND mission_id = ?" : " AND +mission_id = ?";
    filter.values.emplace_back(std::string_view(query.mission_id));
  }
  if (!query.run_id.empty()) {
    filter.sql += " AND run_id = ?";
    filter.values.emplace_back(std::string_view(query.run_id));
  }
  // Word for word the condition of the partial indexes.
  if (open) filter.sql += " AND status NOT IN (6, 7, 8)";
  return filter;
}

ListFilter FilterOf(const PresentQuery& query) {
  if (query.include_expired) return {};
  return {" AND (expires_ms = 0 OR expires_ms > ?)", {UnixMs(query.now)}};
}

absl::StatusOr<FaultRow> ReadFault(const Rows& rows) {
  int column = kFirstOwnColumn;
  FaultRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(column++));
  row.fault.unix_time_ms = rows.Int(column++);
  row.fault.fault_id = Text(rows, column++);
  row.fault.source = Text(rows, column++);
  row.fault.severity =
      static_cast<model::FaultSeverity>(static_cast<std::uint16_t>(rows.Int(column++)));
  row.fault.category = Text(rows, column++);
  row.fault.description = Text(rows, column++);
  row.fault.suggested_action = Text(rows, column++);
  row.fault.active = rows.Int(column) != 0;
  return row;
}

absl::StatusOr<FaultRow> ReadActiveFault(const Rows& rows) {
  absl::StatusOr<FaultRow> row = ReadFault(rows);
  if (row.ok()) row->raised_at = FromUnixMs(rows.Int(kTimeColumn));
  return row;
}

absl::StatusOr<QuarantineRow> ReadQuarantine(const Rows& rows) {
  const absl::StatusOr<model::SessionId> session = SessionOf(rows);
  if (!session.ok()) return session.status();
  int column = kFirstOwnColumn + 1;
  QuarantineRow row;
  row.robot = RobotOf(rows);
  row.session = *session;
  row.received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.seq = static_cast<model::Seq>(rows.Int(column++));
  row.rejection.reason = ReasonOf(rows.Int(column++));
  row.rejection.field = Text(rows, column++);
  row.rejection.detail = Text(rows, column++);
  row.payload_bytes = static_cast<std::uint64_t>(rows.Int(column++));
  row.payload = Text(rows, column);
  return row;
}

absl::StatusOr<GapRow> ReadGap(const Rows& rows) {
  const absl::StatusOr<model::SessionId> session = SessionOf(rows);
  if (!session.ok()) return session.status();
  int column = kFirstOwnColumn + 1;
  GapRow row;
  row.robot = RobotOf(rows);
  row.session = *session;
  row.seen_at = FromUnixMs(rows.Int(kTimeColumn));
  row.first = static_cast<model::Seq>(rows.Int(column++));
  row.last = static_cast<model::Seq>(rows.Int(column));
  return row;
}

absl::StatusOr<EventRow> ReadEvent(const Rows& rows) {
  int column = kFirstOwnColumn;
  EventRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.sampled_at_ms = rows.Int(column++);
  row.kind = Text(rows, column++);
  row.detail_json = Text(rows, column);
  return row;
}

absl::StatusOr<MessageRow> ReadMessage(const Rows& rows) {
  int column = kFirstOwnColumn;
  MessageRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.message.unix_time_ms = rows.Int(column++);
  row.message.level = MemberOf<model::MessageLevel>(rows.Int(column++));
  row.message.message = Text(rows, column);
  return row;
}

absl::StatusOr<MissionRunRow> ReadMissionRun(const Rows& rows) {
  int column = kFirstOwnColumn;
  MissionRunRow row;
  row.robot = RobotOf(rows);
  row.first_received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.mission_id = Text(rows, column++);
  row.run_id = Text(rows, column++);
  row.name = Text(rows, column++);
  row.status = MemberOf<model::MissionStatus>(rows.Int(column++));
  row.latest_json = Text(rows, column++);
  row.last_received_at = FromUnixMs(rows.Int(column++));
  row.updates = static_cast<std::uint64_t>(rows.Int(column));
  return row;
}

absl::StatusOr<MissionReportRow> ReadMissionReport(const Rows& rows) {
  int column = kFirstOwnColumn;
  MissionReportRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.mission_id = Text(rows, column++);
  row.run_id = Text(rows, column++);
  row.status = MemberOf<model::MissionStatus>(rows.Int(column++));
  row.report_json = Text(rows, column);
  return row;
}

absl::StatusOr<ShapeRow> ReadShape(const Rows& rows) {
  int column = kFirstOwnColumn;
  ShapeRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(column++));
  row.expires_at_ms = rows.Int(column++);
  row.identity.id = Text(rows, column++);
  row.identity.name = Text(rows, column++);
  row.identity.rev = static_cast<std::uint32_t>(rows.Int(column++));
  row.identity.hash = Text(rows, column++);
  row.area_type = MemberOf<model::ReportedLayerRole>(rows.Int(column++));
  row.scope = MemberOf<model::ScopeType>(rows.Int(column++));
  row.min_z_m = rows.Real(column++);
  row.max_z_m = rows.Real(column++);
  row.level_id = static_cast<std::int32_t>(rows.Int(column++));
  row.geometry_json = Text(rows, column);
  return row;
}

absl::StatusOr<ObjectRow> ReadObject(const Rows& rows) {
  int column = kFirstOwnColumn;
  ObjectRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(column++));
  row.expires_at_ms = rows.Int(column++);
  row.id = Text(rows, column++);
  row.name = Text(rows, column++);
  row.sampled_at_ms = rows.Int(column++);
  row.object_type = MemberOf<model::ObjectType>(rows.Int(column++));
  row.scope = MemberOf<model::ScopeType>(rows.Int(column++));
  row.radius_m = rows.Real(column++);
  row.location_json = Text(rows, column++);
  row.trajectory_json = Text(rows, column);
  return row;
}

absl::StatusOr<PresenceRow> ReadPresence(const Rows& rows) {
  return PresenceRow{RobotOf(rows), PresenceOf(rows.Int(kFirstOwnColumn)),
                     FromUnixMs(rows.Int(kTimeColumn))};
}

}  // namespace uplink::storage::sqlite
