#include "tests/unit/tools/fleet/compare/twin_mirror.h"

#include <utility>
#include <variant>

#include <google/protobuf/util/json_util.h>

#include "schema/base/check.h"
#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/records.h"
#include "schema/json/render.h"
#include "schema/model/enum_text.h"
#include "server/cyberwave/whose.h"
#include "server/view/timestamps.h"
#include "server/view/twin_json.h"
#include "tests/support/proto_struct.h"

namespace uplink::synthetic {
namespace {

namespace cw = cyberwave;

/// The judgement's twin, as both robots' states need it.
model::cyberwave::Uuid UuidOf(const TwinIds& ids) {
  const auto uuid = model::cyberwave::Uuid::FromText(ids.twin);
  UPLINK_CHECK(uuid.has_value(), "a twin's id is a UUID");
  return *uuid;
}

}  // namespace

/// One overload per record; the row that the contract has for it.
struct TwinMirror::Applier {
  TwinMirror& mirror;
  StoredRobot& robot;

  void operator()(const model::Record& record) { std::visit(*this, record.body()); }
  void operator()(const model::EventTelemetry& record) {
    const auto& named = std::get<model::NamedEvent>(record.kind);
    v1::Event row;
    row.set_kind(named.kind);
    *row.mutable_detail() = test::ParseStruct(named.detail_json);
    view::SetTimeMs(row, &v1::Event::mutable_sampled_at, record.unix_time_ms);
    robot.events.push_back(std::move(row));
  }
  void operator()(const model::Message& record) {
    v1::RobotMessage row;
    row.set_level(model::EnumText(record.level));
    row.set_message(record.message);
    view::SetTimeMs(row, &v1::RobotMessage::mutable_sampled_at, record.unix_time_ms);
    *row.mutable_detail() = test::ParseStruct(record.detail_json);
    robot.messages.push_back(std::move(row));
  }
  template <typename Other>
  void operator()(const Other& /*no message of Cyberwave's becomes one*/) {
    UPLINK_CHECK(false, "a record of Cyberwave's");
  }
  void operator()(const model::MissionRunStatus& record) {
    v1::MissionRun& row = mirror.runs_[record.run_id];
    row.set_run_id(record.run_id);
    row.set_status(model::EnumText(record.status));
    *row.mutable_latest() = test::ToStruct(json::Render(record));
    row.set_updates(row.updates() + 1);
  }
  void operator()(const model::Fault& record) {
    v1::Fault row;
    row.set_fault_id(record.fault_id);
    row.set_source(record.source);
    row.set_active(record.active);
    row.set_description(record.description);
    robot.faults.push_back(row);
    std::erase_if(robot.active_faults,
                  [&row](const v1::Fault& each) { return each.fault_id() == row.fault_id(); });
    if (row.active()) robot.active_faults.push_back(std::move(row));
  }
  void operator()(const model::ScopeUpdate& record) {
    v1::ScopeUpdate row;
    row.set_scope(std::string(model::ToText(record.scope)));
    row.set_id(record.id);
    row.set_type(record.type);
    *row.mutable_detail() = test::ParseStruct(record.detail_json);
    view::SetTimeMs(row, &v1::ScopeUpdate::mutable_sampled_at, record.unix_time_ms);
    mirror.stored.scopes.push_back(std::move(row));
  }
};

TwinMirror::TwinMirror(const TwinOptions& options, int messages)
    : twin(options), prefix_(options.prefix) {
  constexpr std::int64_t kStepUs = 50'000;
  for (auto& state : states_) state = std::make_unique<cw::TwinState>(UuidOf(twin.ids()));
  for (const Publication& each : twin.First(now_us_)) Take(each);
  for (int i = 0; i < messages; ++i) Take(twin.Next(now_us_ += kStepUs));
  for (const Publication& each : twin.Last(now_us_ += kStepUs)) Take(each);
  for (const Side side : {Side::kReal, Side::kSim}) Show(side);
  for (auto& [id, run] : runs_) Of(Side::kReal).runs.push_back(run);
}

void TwinMirror::Take(const Publication& publication) {
  published.push_back(publication);
  if (publication.qos == Qos::k1) {
    twin.account().Published(publication.number);
    twin.account().Acked(publication.number);
  }
  const cw::JudgeTerms terms{.prefixes = {prefix_}, .prismatic_joints = {}};
  cw::Judgement judgement = cw::JudgeMessage(publication.topic, publication.payload, terms);
  dropped += judgement.dropped.size();
  if (judgement.rejection() != nullptr) return Reject(publication, judgement);
  const Side side =
      cw::IsOfTwin(judgement.topic.kind) && cw::RobotOf(judgement) == cw::RobotKind::kSimulated
          ? Side::kSim
          : Side::kReal;
  Applier applier{*this, Of(side)};
  if (!cw::IsOfTwin(judgement.topic.kind)) {
    const auto record = cw::Records::Take(judgement);
    UPLINK_CHECK(record.has_value(), "what is of no twin is durable");
    return std::visit(applier, *record);
  }
  const cw::Arrival arrival{.steady = {}, .system = FromUnixMs(now_us_ / 1000)};
  const cw::Applied applied =
      states_.at(static_cast<std::size_t>(side))->Apply(std::move(judgement), arrival);
  for (const cw::DurableRecord& record : applied.records) std::visit(applier, record);
}

void TwinMirror::Reject(const Publication& publication, const cw::Judgement& judgement) {
  v1::Quarantined row;
  row.set_reason(std::string(model::ToText(judgement.rejection()->reason)));
  row.set_payload(publication.payload);
  row.set_payload_bytes(static_cast<std::int64_t>(publication.payload.size()));
  row.set_source("cyberwave");
  row.set_topic(publication.topic);
  const bool of_twin = publication.topic.find(twin.ids().twin) != std::string::npos;
  if (!of_twin) {
    nobody.push_back(std::move(row));
    return;
  }
  Of(cw::RobotOf(judgement) == cw::RobotKind::kReal ? Side::kReal : Side::kSim)
      .quarantine.push_back(std::move(row));
}

void TwinMirror::Show(Side side) {
  v1::PresenceChange online;
  online.set_presence("online");
  view::SetTimeMs(online, &v1::PresenceChange::mutable_at, kTwinStartUs / 1000);
  Of(side).presence.push_back(std::move(online));
  const auto& state = *states_.at(static_cast<std::size_t>(side));
  look.at(static_cast<std::size_t>(side)) =
      boost::json::serialize(boost::json::object{{"presence", "online"},
                                                 {"source", "cyberwave"},
                                                 {"cyberwave", view::TwinJson(state.parts())}});
}

}  // namespace uplink::synthetic
