#include "schema/model/enum_text.h"
#include "schema/model/rejection.h"
#include "server/view/messages.h"
#include "server/view/timestamps.h"

// Histories, and the active set of faults.
namespace uplink::view {

v1::Fault ToMessage(const storage::FaultRow& row) {
  v1::Fault message;
  message.set_ruri(row.robot.ruri);
  message.set_fault_id(row.fault.fault_id);
  message.set_source(row.fault.source);
  message.set_severity(model::EnumText(row.fault.severity));
  message.set_active(row.fault.active);
  message.set_category(row.fault.category);
  message.set_description(row.fault.description);
  message.set_suggested_action(row.fault.suggested_action);
  SetTimeMs(message, &v1::Fault::mutable_sampled_at, row.fault.unix_time_ms);
  SetTime(message, &v1::Fault::mutable_received_at, row.received_at);
  SetTime(message, &v1::Fault::mutable_raised_at, row.raised_at);
  if (row.acknowledged_at) {
    v1::FaultAcknowledgement& seen = *message.mutable_acknowledgement();
    SetTime(seen, &v1::FaultAcknowledgement::mutable_at, row.acknowledged_at);
    seen.set_by(row.acknowledged_by);
    seen.set_note(row.acknowledged_note);
  }
  return message;
}

v1::Event ToMessage(const storage::EventRow& row) {
  v1::Event event;
  event.set_ruri(row.robot.ruri);
  event.set_kind(row.kind);
  SetTimeMs(event, &v1::Event::mutable_sampled_at, row.sampled_at_ms);
  SetTime(event, &v1::Event::mutable_received_at, row.received_at);
  return event;
}

TextMembers TextsOf(const storage::EventRow& row) {
  TextMembers texts;
  // Always there, empty where the kind holds nothing.
  texts.AddStored("detail", row.detail_json);
  return texts;
}

v1::RobotMessage ToMessage(const storage::MessageRow& row) {
  v1::RobotMessage item;
  item.set_ruri(row.robot.ruri);
  item.set_level(model::EnumText(row.message.level));
  item.set_message(row.message.message);
  if (!row.message.source_level.empty()) item.set_source_level(row.message.source_level);
  SetTimeMs(item, &v1::RobotMessage::mutable_sampled_at, row.message.unix_time_ms);
  SetTime(item, &v1::RobotMessage::mutable_received_at, row.received_at);
  return item;
}

TextMembers TextsOf(const storage::MessageRow& row) {
  TextMembers texts;
  if (!row.message.detail_json.empty()) texts.AddStored("detail", row.message.detail_json);
  return texts;
}

v1::PresenceChange ToMessage(const storage::PresenceRow& row) {
  v1::PresenceChange change;
  change.set_ruri(row.robot.ruri);
  change.set_presence(std::string(model::ToText(row.presence)));
  SetTime(change, &v1::PresenceChange::mutable_at, row.at);
  if (row.why) change.set_why(std::string(model::ToText(*row.why)));
  return change;
}

v1::Quarantined ToMessage(const storage::QuarantineRow& row) {
  v1::Quarantined item;
  if (!storage::IsNoRobot(row.robot.ruri)) item.set_ruri(row.robot.ruri);
  item.set_session_id(row.session.ToHex());
  item.set_seq(row.seq);
  item.set_reason(std::string(model::ToText(row.rejection.reason)));
  item.set_field(row.rejection.field);
  item.set_detail(row.rejection.detail);
  SetTime(item, &v1::Quarantined::mutable_received_at, row.received_at);
  item.set_payload(row.payload);
  item.set_payload_bytes(Signed(row.payload_bytes));
  item.set_source(std::string(model::ToText(row.source)));
  item.set_topic(row.topic);
  return item;
}

v1::ScopeUpdate ToMessage(const storage::ScopeUpdateRow& row) {
  v1::ScopeUpdate item;
  item.set_scope(std::string(model::ToText(row.update.scope)));
  item.set_id(row.update.id);
  item.set_type(row.update.type);
  SetTimeMs(item, &v1::ScopeUpdate::mutable_sampled_at, row.update.unix_time_ms);
  SetTime(item, &v1::ScopeUpdate::mutable_received_at, row.received_at);
  return item;
}

TextMembers TextsOf(const storage::ScopeUpdateRow& row) {
  TextMembers texts;
  texts.AddStored("detail", row.update.detail_json);
  return texts;
}

v1::MissionReport ToMessage(const storage::MissionReportRow& row) {
  v1::MissionReport report;
  report.set_ruri(row.robot.ruri);
  report.set_mission_id(row.mission_id);
  report.set_run_id(row.run_id);
  report.set_status(model::EnumText(row.status));
  SetTime(report, &v1::MissionReport::mutable_received_at, row.received_at);
  return report;
}

TextMembers TextsOf(const storage::MissionReportRow& row) {
  TextMembers texts;
  texts.AddStored("report", row.report_json);
  return texts;
}

v1::Gap ToMessage(const storage::GapRow& row) {
  v1::Gap gap;
  gap.set_ruri(row.robot.ruri);
  gap.set_session_id(row.session.ToHex());
  gap.set_first_seq(row.first);
  gap.set_last_seq(row.last);
  SetTime(gap, &v1::Gap::mutable_seen_at, row.seen_at);
  return gap;
}

}  // namespace uplink::view
