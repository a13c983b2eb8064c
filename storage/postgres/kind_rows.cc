#include "storage/postgres/kind_rows.h"

#include <string>

#include "storage/numbers.h"
#include "storage/postgres/rejection_row.h"

namespace uplink::storage::postgres {
namespace {

/// The columns of one row, taken in their order.
class Columns final {
 public:
  Columns(const Result& rows, int row) : rows_(rows), row_(row) {}

  std::string Text() { return std::string(rows_.Bytes(row_, column_++)); }
  std::int64_t Int() { return rows_.Int(row_, column_++); }
  bool Bool() { return rows_.Bool(row_, column_++); }
  double Real() { return rows_.Real(row_, column_++); }
  SystemTime Time() { return rows_.Time(row_, column_++); }
  model::SessionId Uuid() { return rows_.Uuid(row_, column_++); }

  [[nodiscard]] model::RobotId robot() const {
    return {std::string(rows_.Bytes(row_, kRuriColumn)),
            std::string(rows_.Bytes(row_, kFleetColumn))};
  }
  [[nodiscard]] SystemTime time() const { return rows_.Time(row_, kTimeColumn); }

 private:
  const Result& rows_;
  const int row_;
  int column_ = kFirstOwnColumn;
};

}  // namespace

ListFilter FilterOf(const MissionsQuery& query, bool open) {
  ListFilter filter;
  if (!query.mission_id.empty()) {
    filter.conditions.push_back({"mission_id = ?", std::string_view(query.mission_id)});
  }
  if (!query.run_id.empty()) {
    filter.conditions.push_back({"run_id = ?", std::string_view(query.run_id)});
  }
  if (open) filter.conditions.push_back({"is_open", {}});
  return filter;
}

ListFilter FilterOf(const PresentQuery& query) {
  if (query.include_expired) return {};
  return {{{"(expires_ms = 0 OR expires_ms > ?)", UnixMs(query.now)}}};
}

FaultRow ReadFault(const Result& rows, int row) {
  Columns columns(rows, row);
  FaultRow fault;
  fault.robot = columns.robot();
  fault.received_at = columns.Time();
  fault.fault.unix_time_ms = columns.Int();
  fault.fault.fault_id = columns.Text();
  fault.fault.source = columns.Text();
  fault.fault.severity = MemberOf<model::FaultSeverity>(columns.Int());
  fault.fault.category = columns.Text();
  fault.fault.description = columns.Text();
  fault.fault.suggested_action = columns.Text();
  fault.fault.active = columns.Bool();
  return fault;
}

FaultRow ReadActiveFault(const Result& rows, int row) {
  FaultRow fault = ReadFault(rows, row);
  fault.raised_at = rows.Time(row, kTimeColumn);
  return fault;
}

QuarantineRow ReadQuarantine(const Result& rows, int row) {
  Columns columns(rows, row);
  QuarantineRow set_aside;
  set_aside.robot = columns.robot();
  set_aside.received_at = columns.time();
  set_aside.session = columns.Uuid();
  set_aside.seq = static_cast<model::Seq>(columns.Int());
  set_aside.rejection.reason = ReasonOf(columns.Int());
  set_aside.rejection.field = columns.Text();
  set_aside.rejection.detail = columns.Text();
  set_aside.payload_bytes = static_cast<std::uint64_t>(columns.Int());
  set_aside.payload = columns.Text();
  return set_aside;
}

GapRow ReadGap(const Result& rows, int row) {
  Columns columns(rows, row);
  GapRow gap;
  gap.robot = columns.robot();
  gap.seen_at = columns.time();
  gap.session = columns.Uuid();
  gap.first = static_cast<model::Seq>(columns.Int());
  gap.last = static_cast<model::Seq>(columns.Int());
  return gap;
}

EventRow ReadEvent(const Result& rows, int row) {
  Columns columns(rows, row);
  EventRow event;
  event.robot = columns.robot();
  event.received_at = columns.time();
  event.sampled_at_ms = columns.Int();
  event.kind = columns.Text();
  event.detail_json = columns.Text();
  return event;
}

MessageRow ReadMessage(const Result& rows, int row) {
  Columns columns(rows, row);
  MessageRow message;
  message.robot = columns.robot();
  message.received_at = columns.time();
  message.message.unix_time_ms = columns.Int();
  message.message.level = MemberOf<model::MessageLevel>(columns.Int());
  message.message.message = columns.Text();
  return message;
}

MissionRunRow ReadMissionRun(const Result& rows, int row) {
  Columns columns(rows, row);
  MissionRunRow run;
  run.robot = columns.robot();
  run.first_received_at = columns.time();
  run.mission_id = columns.Text();
  run.run_id = columns.Text();
  run.name = columns.Text();
  run.status = MemberOf<model::MissionStatus>(columns.Int());
  run.latest_json = columns.Text();
  run.last_received_at = columns.Time();
  run.updates = static_cast<std::uint64_t>(columns.Int());
  return run;
}

MissionReportRow ReadMissionReport(const Result& rows, int row) {
  Columns columns(rows, row);
  MissionReportRow report;
  report.robot = columns.robot();
  report.received_at = columns.time();
  report.mission_id = columns.Text();
  report.run_id = columns.Text();
  report.status = MemberOf<model::MissionStatus>(columns.Int());
  report.report_json = columns.Text();
  return report;
}

ShapeRow ReadShape(const Result& rows, int row) {
  Columns columns(rows, row);
  ShapeRow shape;
  shape.robot = columns.robot();
  shape.received_at = columns.Time();
  shape.expires_at_ms = columns.Int();
  shape.identity.id = columns.Text();
  shape.identity.name = columns.Text();
  shape.identity.rev = static_cast<std::uint32_t>(columns.Int());
  shape.identity.hash = columns.Text();
  shape.area_type = MemberOf<model::ReportedLayerRole>(columns.Int());
  shape.scope = MemberOf<model::ScopeType>(columns.Int());
  shape.min_z_m = columns.Real();
  shape.max_z_m = columns.Real();
  shape.level_id = static_cast<std::int32_t>(columns.Int());
  shape.geometry_json = columns.Text();
  return shape;
}

ObjectRow ReadObject(const Result& rows, int row) {
  Columns columns(rows, row);
  ObjectRow object;
  object.robot = columns.robot();
  object.received_at = columns.Time();
  object.expires_at_ms = columns.Int();
  object.id = columns.Text();
  object.name = columns.Text();
  object.sampled_at_ms = columns.Int();
  object.object_type = MemberOf<model::ObjectType>(columns.Int());
  object.scope = MemberOf<model::ScopeType>(columns.Int());
  object.radius_m = columns.Real();
  object.location_json = columns.Text();
  object.trajectory_json = columns.Text();
  return object;
}

PresenceRow ReadPresence(const Result& rows, int row) {
  Columns columns(rows, row);
  return {columns.robot(), PresenceOf(columns.Int()), columns.time()};
}

}  // namespace uplink::storage::postgres
