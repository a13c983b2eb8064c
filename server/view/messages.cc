#include "server/view/messages.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "metrics/kinds.h"
#include "schema/model/message_source.h"
#include "schema/model/rejection.h"
#include "server/robot/source_of.h"
#include "server/view/drone_json.h"
#include "server/view/live_parts.h"
#include "server/view/timestamps.h"
#include "server/view/twin_json.h"

namespace uplink::view {
namespace {

void SetSession(const robot::SessionView& session, v1::Robot& message) {
  message.set_connected(session.connected);
  if (session.connected) {
    SetTime(message, &v1::Robot::mutable_connected_since, session.connected_since);
  }
  if (session.session) message.set_session_id(session.session->ToHex());
  message.set_settled_seq(session.settled_seq);
  message.set_uplinks_missing(Signed(session.missing));
  message.set_contested(session.contested);
  message.set_gateway(session.gateway);
  if (session.held_back == robot::HeldBack::kNone) return;
  message.set_held_back(std::string(robot::ToText(session.held_back)));
  SetTime(message, &v1::Robot::mutable_held_back_since, session.held_back_since);
}

/// How far behind the robot's agent is, and how far off its clock.
void SetAgent(const robot::StateSnapshot& state, v1::Robot& message) {
  if (state.clock_skew_ms) message.set_clock_skew_ms(*state.clock_skew_ms);
  if (!state.backlog) return;
  v1::Backlog& backlog = *message.mutable_backlog();
  backlog.set_uplinks(state.backlog->uplinks);
  if (state.backlog->oldest_unsent) {
    SetTime(backlog, &v1::Backlog::mutable_oldest_unsent, *state.backlog->oldest_unsent);
  }
  SetTime(backlog, &v1::Backlog::mutable_said_at, state.backlog->said_at);
}

/// Battery, position, e-stop.
void SetVitals(const Vitals& vitals, v1::Robot& message) {
  if (vitals.battery_percent) message.set_battery_percent(*vitals.battery_percent);
  if (vitals.estop) message.set_estop(*vitals.estop);
  if (vitals.place) {
    v1::Position& position = *message.mutable_position();
    position.set_frame("wgs84");
    position.set_latitude(vitals.place->latitude_deg);
    position.set_longitude(vitals.place->longitude_deg);
    if (vitals.place->altitude_m) position.set_altitude(*vitals.place->altitude_m);
  } else if (vitals.local_place) {
    v1::Position& position = *message.mutable_position();
    position.set_frame("local");
    position.set_x(vitals.local_place->x_m);
    position.set_y(vitals.local_place->y_m);
    if (vitals.local_place->z_m) position.set_z(*vitals.local_place->z_m);
  }
}

/// What operators set of it.
void SetDecided(const storage::RobotSetting& set, v1::Robot& message) {
  message.mutable_labels()->insert(set.labels.begin(), set.labels.end());
  message.set_note(set.note);
  message.set_blocked(set.blocked);
  message.set_registered(set.registered);
}

void AddStoredParts(const StoredParts& stored, const PartSet& wanted, TextMembers& texts) {
  if (wanted.Has(Part::kAgentInfo) && stored.agent_info) {
    texts.AddStored("agentInfo", *stored.agent_info);
  }
  if (wanted.Has(Part::kSettings) && stored.settings) {
    texts.AddStored("settings", *stored.settings);
  }
  if (wanted.Has(Part::kUiCapabilities) && stored.ui_capabilities) {
    texts.AddStored("uiCapabilities", *stored.ui_capabilities);
  }
}

void SetConnection(const BrokerConnection& connection, v1::MqttConnection& message) {
  message.set_name(connection.name);
  message.set_client_id(connection.client_id);
  message.set_state(connection.state);
  SetTime(message, &v1::MqttConnection::mutable_connected_since, connection.connected_since);
  message.set_session_present(connection.session_present);
  message.set_unacked(Signed(connection.unacked));
  message.set_filters_refused(Signed(connection.filters_refused));
  message.set_filters_lower(Signed(connection.filters_lower));
  message.set_last_error(connection.last_error);
  SetTime(message, &v1::MqttConnection::mutable_last_error_at, connection.last_error_at);
}

void SetBroker(const BrokerStatus& broker, v1::MqttStatus& message) {
  message.set_url(broker.url);
  message.set_holds_lease(broker.holds_lease);
  message.set_held_by(broker.held_by);
  for (const std::string& prefix : broker.prefixes) message.add_prefixes(prefix);
  message.set_twins(Signed(broker.twins));
  SetTime(message, &v1::MqttStatus::mutable_subscribed_since, broker.subscribed_since);
  for (const BrokerConnection& connection : broker.connections) {
    SetConnection(connection, *message.add_connections());
  }
}

}  // namespace

std::int64_t Signed(std::uint64_t value) {
  constexpr auto kTop = std::numeric_limits<std::int64_t>::max();
  return value > static_cast<std::uint64_t>(kTop) ? kTop : static_cast<std::int64_t>(value);
}

v1::Robot ToMessage(const RobotView& robot) {
  v1::Robot message;
  message.set_ruri(robot.id.ruri);
  message.set_fleet(robot.id.fleet);
  const model::MessageSource source = robot::SourceOf(robot.id.ruri);
  message.set_source(std::string(ToText(source)));
  message.set_presence(std::string(ToText(robot.state.presence)));
  SetTime(message, &v1::Robot::mutable_presence_since, robot.state.presence_since);
  SetTime(message, &v1::Robot::mutable_last_sign_of_life, robot.state.last_sign_of_life);
  if (robot.state.parked_until) {
    SetTime(message, &v1::Robot::mutable_parked_until, *robot.state.parked_until);
  }
  message.set_flapping(robot.state.flapping);
  if (robot.state.foreign) {
    message.set_held_by(robot.state.foreign->held_by);
    SetTime(message, &v1::Robot::mutable_held_by_at, robot.state.foreign->written_at);
  }
  SetSession(robot.session, message);
  if (robot.is_drone) {
    // A drone that also has a session of the relay reports over both.
    message.set_source(message.session_id().empty() ? "uncrew" : "uplink,uncrew");
    message.set_operator_requests_open(static_cast<std::int32_t>(robot.operator_requests_open));
  }
  if (source != model::MessageSource::kUplink) {
    // The stream is our own: it does not mean that the robot has a link to us.
    message.set_connected(false);
    message.clear_connected_since();
  }
  SetAgent(robot.state, message);
  SetVitals(robot.glance.vitals, message);
  message.set_agent_version(robot.glance.agent_version);
  SetTime(message, &v1::Robot::mutable_certificate_not_after, robot.glance.certificate_not_after);
  if (robot.glance.certificate_days_left) {
    message.set_certificate_days_left(*robot.glance.certificate_days_left);
  }
  if (robot.set != nullptr) SetDecided(*robot.set, message);
  constexpr std::int64_t kFaultsTop = std::numeric_limits<std::int32_t>::max();
  message.set_active_faults(static_cast<std::int32_t>(std::min(robot.active_faults, kFaultsTop)));
  message.set_fields_dropped(robot.state.fields_dropped);
  for (std::size_t kind = 0; kind < metrics::kKinds; ++kind) {
    const std::uint64_t limited = robot.rate_limited[kind];
    if (limited == 0) continue;
    const std::string_view name = metrics::KindText(kind);
    (*message.mutable_rate_limited())[std::string(name)] = Signed(limited);
  }
  return message;
}

TextMembers TextsOf(const RobotView& robot, const PartSet& parts) {
  TextMembers texts;
  AddLiveParts(robot.state.parts, parts, robot.id.ruri, texts);
  AddStoredParts(robot.stored, parts, texts);
  if (robot.twin && parts.Has(Part::kCyberwave)) texts.Add("cyberwave", TwinJson(*robot.twin));
  if (robot.drone && parts.Has(Part::kUncrew)) texts.Add("uncrew", DroneJson(*robot.drone));
  return texts;
}

namespace {

using Counts = google::protobuf::Map<std::string, std::int64_t>;

void SetRejects(const metrics::MessageCounts& counts, Counts& rejects) {
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    rejects[std::string(model::ToText(reason))] =
        Signed(counts.rejects[static_cast<std::size_t>(reason)]);
  }
}

void SetMessages(const metrics::MessageCounts& counts, v1::MessageCounts& message) {
  Counts& fates = *message.mutable_counts();
  fates["received"] = Signed(counts.received);
  fates["inFlight"] = counts.in_flight;
  for (const metrics::BecameColumn& column : metrics::kBecame) {
    fates[std::string(column.name)] = Signed(counts.*column.count);
  }
  SetRejects(counts, *message.mutable_rejects_by_reason());
}

}  // namespace

v1::ServerStatus ToMessage(const StatusView& status, const std::vector<std::string>& degraded) {
  v1::ServerStatus message;
  message.set_version(status.version);
  SetTime(message, &v1::ServerStatus::mutable_started_at, status.started_at);
  SetTime(message, &v1::ServerStatus::mutable_now, status.now);
  auto& robots = *message.mutable_robots();
  robots["online"] = status.robots.online;
  robots["offline"] = status.robots.offline;
  robots["unknown"] = status.robots.unknown;
  message.set_streams(status.streams);
  const metrics::MessageCounts& relayed =
      status.messages[static_cast<std::size_t>(model::MessageSource::kUplink)];
  auto& uplinks = *message.mutable_uplinks();
  uplinks["received"] = Signed(relayed.received);
  uplinks["stored"] = Signed(relayed.stored);
  uplinks["applied"] = Signed(relayed.applied);
  uplinks["superseded"] = Signed(relayed.superseded);
  uplinks["duplicate"] = Signed(relayed.duplicate);
  uplinks["rejected"] = Signed(relayed.rejected);
  uplinks["inFlight"] = relayed.in_flight;
  SetRejects(relayed, *message.mutable_rejects_by_reason());
  metrics::MessageCounts all;
  for (const model::MessageSource source : model::kAllMessageSources) {
    const metrics::MessageCounts& counts = status.messages[static_cast<std::size_t>(source)];
    SetMessages(counts, (*message.mutable_messages_by_source())[std::string(ToText(source))]);
    all += counts;
  }
  SetMessages(all, *message.mutable_messages());
  message.set_journal_records(Signed(status.journal_records));
  message.set_journal_bytes(Signed(status.journal_bytes));
  message.set_journal_oldest_ms(status.journal_oldest.count());
  for (const std::string& word : degraded) message.add_degraded(word);
  if (status.broker) SetBroker(*status.broker, *message.mutable_mqtt());
  return message;
}

}  // namespace uplink::view
