#include "tests/unit/tools/fleet/compare/mirror.h"

#include <span>

#include "schema/base/check.h"
#include "schema/model/enum_text.h"
#include "server/view/timestamps.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

template <typename Row>
Row Arrived(Row row, std::int64_t at_ms) {
  row.set_ruri(kRuri);
  view::SetTimeMs(row, &Row::mutable_received_at, at_ms);
  return row;
}

google::protobuf::Struct& At(google::protobuf::Struct& part, const std::string& key) {
  return *(*part.mutable_fields())[key].mutable_struct_value();
}

}  // namespace

Mirror::Mirror(double malformed_share, int ticks) {
  ScenarioOptions options;
  options.run = kRun;
  options.malformed_share = malformed_share;
  options.faults_hz = 0.5;
  RobotScript script(options, 0);
  for (int i = 0; i < ticks; ++i) {
    now_ms += 100;
    for (const Outgoing& message : script.Tick(now_ms, robot.account)) Take(message);
  }
  for (const Outgoing& message : script.Last(now_ms, robot.account)) Take(message);
  Expire();
  robot.ruri = kRuri;
  robot.session_hex = kSession;
  robot.mark = MarkOf(kRun, 0);
  robot.last_seq = robot.sent = seq_;
  robot.all_settled = robot.ended_ok = true;
  live.set_ruri(kRuri);
  live.set_presence("online");
  live.set_connected(true);
  v1::PresenceChange& online = stored.presence.emplace_back();
  online.set_presence("online");
  view::SetTimeMs(online, &v1::PresenceChange::mutable_at, kStartMs);
  for (const auto& [key, row] : active_) stored.active_faults.push_back(row);
  for (const auto& [key, row] : runs_) stored.runs.push_back(row);
  for (const auto& [id, row] : shapes_) stored.shapes.push_back(row);
  for (const auto& [id, row] : objects_) stored.objects.push_back(row);
  stored.read = {now_ms, now_ms};
}

void Mirror::Take(const Outgoing& message) {
  ++seq_;
  Settled settled{.seq = seq_, .tag = message.tag, .rejection = std::nullopt};
  const bool none = message.content == Content::kNone;
  const schema::Judgement judgement = judge_.Payload(std::as_bytes(std::span(message.payload)));
  if (!none && judgement.record() != nullptr) {
    ++sent[judgement.record()->variant()];
    Show(judgement.record()->body());
  } else {
    settled.rejection = none ? model::Rejection{model::RejectReason::kUnsupportedContent, "", ""}
                             : *judgement.rejection();
    v1::Quarantined& row = stored.quarantine.emplace_back();
    row.set_session_id(kSession);
    row.set_seq(seq_);
    row.set_reason(std::string(model::ToText(settled.rejection->reason)));
    row.set_field(settled.rejection->field);
  }
  if (message.keeping == Keeping::kDurable) robot.account.Settle(std::move(settled));
}

void Mirror::Show(const model::Body& body) {
  ShowRow(body);
  ShowLatest(body);
  ShowLive(body);
}

void Mirror::ShowRow(const model::Body& body) {
  if (const auto* fault = std::get_if<model::Fault>(&body)) {
    const v1::Fault row = Arrived(RowOf(*fault), now_ms);
    stored.faults.insert(stored.faults.begin(), row);
    const std::pair key{fault->fault_id, fault->source};
    if (!fault->active) {
      active_.erase(key);
    } else {
      const std::int64_t raised_ms =
          active_.contains(key) ? view::UnixMs(active_[key].raised_at()) : now_ms;
      active_[key] = row;
      view::SetTimeMs(active_[key], &v1::Fault::mutable_raised_at, raised_ms);
    }
  } else if (const auto* event = std::get_if<model::EventTelemetry>(&body)) {
    stored.events.insert(stored.events.begin(), Arrived(RowOf(*event), now_ms));
  } else if (const auto* message = std::get_if<model::Message>(&body)) {
    stored.messages.insert(stored.messages.begin(), Arrived(RowOf(*message), now_ms));
  } else if (const auto* report = std::get_if<model::MissionRunStatus>(&body)) {
    v1::MissionRun& run = runs_[{report->mission_id, report->run_id}];
    run.set_ruri(kRuri);
    run.set_mission_id(report->mission_id);
    run.set_run_id(report->run_id);
    if (report->name) run.set_name(*report->name);
    run.set_status(model::EnumText(report->status));
    *run.mutable_latest() = PartOf(*report);
    if (view::UnixMs(run.first_received_at()) == 0)
      view::SetTimeMs(run, &v1::MissionRun::mutable_first_received_at, now_ms);
    view::SetTimeMs(run, &v1::MissionRun::mutable_last_received_at, now_ms);
    run.set_updates(run.updates() + 1);
  }
}

void Mirror::ShowLatest(const model::Body& body) {
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    shapes_.erase(shape->id());
    if (shape->upsert() != nullptr) shapes_[shape->id()] = Arrived(RowOf(*shape->upsert()), now_ms);
  } else if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    objects_.erase(object->id());
    if (object->upsert() == nullptr) return;
    v1::TrackedObject& row = objects_[object->id()];
    row = Arrived(RowOf(*object->upsert()), now_ms);
    if (view::UnixMs(row.expires_at()) == 0)
      view::SetTimeMs(row, &v1::TrackedObject::mutable_expires_at, now_ms + 86'400'000);
  } else if (const auto* info = std::get_if<model::AgentInfo>(&body)) {
    *live.mutable_agent_info() = PartOf(*info);
  } else if (const auto* settings = std::get_if<model::CurrentSettings>(&body)) {
    *live.mutable_settings() = PartOf(*settings);
  } else if (const auto* capabilities = std::get_if<model::UiCapabilities>(&body)) {
    *live.mutable_ui_capabilities() = PartOf(*capabilities);
  }
}

void Mirror::ShowLive(const model::Body& body) {
  if (const auto* motion = std::get_if<model::MotionTelemetry>(&body)) {
    *live.mutable_motion() = PartOf(*motion);
  } else if (const auto* status = std::get_if<model::StatusTelemetry>(&body)) {
    *live.mutable_status() = PartOf(*status);
  } else if (const auto* usage = std::get_if<model::UsageTelemetry>(&body)) {
    *live.mutable_usage() = PartOf(*usage);
  } else if (const auto* extras = std::get_if<model::TelemetryExtras>(&body)) {
    std::map<std::string, model::SensorReading> readings;
    for (model::SensorReading reading : extras->kv) {
      if (!reading.unix_time_ms) reading.unix_time_ms = extras->unix_time_ms;
      readings[reading.key] = reading;
    }
    live.mutable_extras()->MergeFrom(PartOf(readings));
  } else if (const auto* health = std::get_if<model::SystemHealth>(&body)) {
    At(*live.mutable_health(), health->device_id) = PartOf(*health);
  } else if (const auto* tank = std::get_if<model::ConsumableStatus>(&body)) {
    At(*live.mutable_consumables(), tank->kind + "/" + tank->tank_id) = PartOf(*tank);
  } else if (const auto* directive = std::get_if<model::SpatialDirectiveStatus>(&body)) {
    At(*live.mutable_directives(), directive->directive_id) = PartOf(*directive);
  }
}

void Mirror::Expire() {
  const auto expired = [this](const auto& row) {
    return view::UnixMs(row.second.expires_at()) != 0 &&
           view::UnixMs(row.second.expires_at()) <= now_ms;
  };
  std::erase_if(shapes_, expired);
  std::erase_if(objects_, expired);
}

}  // namespace uplink::synthetic
