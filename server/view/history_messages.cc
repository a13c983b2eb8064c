#include "schema/model/enum_text.h"
#include "schema/model/rejection.h"
#include "server/view/messages.h"
#include "server/view/struct.h"

// Histories, and the active set of faults.
namespace uplink::view {
namespace {

void SetFault(const storage::FaultRow& row, v1::Fault& message) {
  message.set_ruri(row.robot.ruri);
  message.set_fault_id(row.fault.fault_id);
  message.set_source(row.fault.source);
  message.set_severity(model::EnumText(row.fault.severity));
  message.set_active(row.fault.active);
  message.set_category(row.fault.category);
  message.set_description(row.fault.description);
  message.set_suggested_action(row.fault.suggested_action);
  message.set_sampled_at_ms(row.fault.unix_time_ms);
  message.set_received_at_ms(UnixMs(row.received_at));
  if (row.raised_at) message.set_raised_at_ms(UnixMs(*row.raised_at));
}

}  // namespace

v1::ListFaultsResponse ToMessage(const storage::Page<storage::FaultRow>& page) {
  v1::ListFaultsResponse message;
  for (const storage::FaultRow& row : page.rows) SetFault(row, *message.add_faults());
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListEventsResponse ToMessage(const storage::Page<storage::EventRow>& page) {
  v1::ListEventsResponse message;
  for (const storage::EventRow& row : page.rows) {
    v1::Event& event = *message.add_events();
    event.set_ruri(row.robot.ruri);
    event.set_kind(row.kind);
    // Always there, empty where the kind holds nothing.
    *event.mutable_detail() = ParseStruct(row.detail_json);
    event.set_sampled_at_ms(row.sampled_at_ms);
    event.set_received_at_ms(UnixMs(row.received_at));
  }
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListMessagesResponse ToMessage(const storage::Page<storage::MessageRow>& page) {
  v1::ListMessagesResponse message;
  for (const storage::MessageRow& row : page.rows) {
    v1::RobotMessage& item = *message.add_messages();
    item.set_ruri(row.robot.ruri);
    item.set_level(model::EnumText(row.message.level));
    item.set_message(row.message.message);
    item.set_sampled_at_ms(row.message.unix_time_ms);
    item.set_received_at_ms(UnixMs(row.received_at));
    if (!row.message.detail_json.empty()) {
      *item.mutable_detail() = ParseStruct(row.message.detail_json);
    }
  }
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListPresenceChangesResponse ToMessage(const storage::Page<storage::PresenceRow>& page) {
  v1::ListPresenceChangesResponse message;
  for (const storage::PresenceRow& row : page.rows) {
    v1::PresenceChange& change = *message.add_changes();
    change.set_ruri(row.robot.ruri);
    change.set_presence(ToMessage(row.presence));
    change.set_at_ms(UnixMs(row.at));
  }
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListQuarantineResponse ToMessage(const storage::Page<storage::QuarantineRow>& page) {
  v1::ListQuarantineResponse message;
  for (const storage::QuarantineRow& row : page.rows) {
    v1::Quarantined& item = *message.add_items();
    if (!storage::IsNoRobot(row.robot.ruri)) item.set_ruri(row.robot.ruri);
    item.set_session_id(row.session.ToHex());
    item.set_seq(row.seq);
    item.set_reason(std::string(model::ToText(row.rejection.reason)));
    item.set_field(row.rejection.field);
    item.set_detail(row.rejection.detail);
    item.set_received_at_ms(UnixMs(row.received_at));
    item.set_payload(row.payload);
    item.set_payload_bytes(Signed(row.payload_bytes));
    item.set_source(std::string(model::ToText(row.source)));
    item.set_topic(row.topic);
  }
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListQuarantineResponse ToMessage(const QuarantineView& quarantine) {
  v1::ListQuarantineResponse message = ToMessage(quarantine.page);
  for (const storage::DroppedRow& dropped : quarantine.dropped) {
    (*message.mutable_dropped_by_reason())[std::string(model::ToText(dropped.reason))] =
        Signed(dropped.count);
  }
  return message;
}

v1::ListScopeUpdatesResponse ToMessage(const storage::Page<storage::ScopeUpdateRow>& page) {
  v1::ListScopeUpdatesResponse message;
  for (const storage::ScopeUpdateRow& row : page.rows) {
    v1::ScopeUpdate& item = *message.add_updates();
    item.set_scope(std::string(model::ToText(row.update.scope)));
    item.set_id(row.update.id);
    item.set_type(row.update.type);
    *item.mutable_detail() = ParseStruct(row.update.detail_json);
    item.set_sampled_at_ms(row.update.unix_time_ms);
    item.set_received_at_ms(UnixMs(row.received_at));
  }
  message.set_next_page_token(page.next_token);
  return message;
}

v1::ListGapsResponse ToMessage(const storage::Page<storage::GapRow>& page) {
  v1::ListGapsResponse message;
  for (const storage::GapRow& row : page.rows) {
    v1::Gap& gap = *message.add_gaps();
    gap.set_ruri(row.robot.ruri);
    gap.set_session_id(row.session.ToHex());
    gap.set_first_seq(row.first);
    gap.set_last_seq(row.last);
    gap.set_seen_at_ms(UnixMs(row.seen_at));
  }
  message.set_next_page_token(page.next_token);
  return message;
}

}  // namespace uplink::view
