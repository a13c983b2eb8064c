#include "tests/unit/tools/fleet/compare/drone_mirror.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include <boost/json.hpp>

#include "schema/base/check.h"
#include "schema/model/enum_text.h"
#include "schema/uncrew/judge.h"
#include "schema/uncrew/records.h"
#include "server/uncrew/sample_digest.h"
#include "server/view/drone_json.h"
#include "server/view/timestamps.h"
#include "tests/support/proto_struct.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;

}  // namespace

/// One overload per record; the row that the contract has for it.
struct DroneMirror::Applier {
  StoredDrone& stored;
  std::int64_t at_ms;

  void operator()(const model::Record& record) { std::visit(*this, record.body()); }
  void operator()(const model::EventTelemetry& record) {
    const auto& named = std::get<model::NamedEvent>(record.kind);
    v1::Event row;
    row.set_kind(named.kind);
    *row.mutable_detail() = test::ParseStruct(named.detail_json);
    view::SetTimeMs(row, &v1::Event::mutable_sampled_at, record.unix_time_ms);
    stored.robot.events.push_back(std::move(row));
  }
  void operator()(const model::Message& record) {
    v1::RobotMessage row;
    row.set_level(model::EnumText(record.level));
    row.set_message(record.message);
    view::SetTimeMs(row, &v1::RobotMessage::mutable_sampled_at, record.unix_time_ms);
    row.set_source_level(record.source_level);
    stored.robot.messages.push_back(std::move(row));
  }
  void operator()(const model::Fault& record) {
    v1::Fault row;
    row.set_fault_id(record.fault_id);
    row.set_source(record.source);
    row.set_severity(model::EnumText(record.severity));
    row.set_active(record.active);
    row.set_category(record.category);
    row.set_description(record.description);
    view::SetTimeMs(row, &v1::Fault::mutable_sampled_at, record.unix_time_ms);
    stored.robot.faults.push_back(row);
    std::erase_if(stored.robot.active_faults,
                  [&row](const v1::Fault& each) { return each.fault_id() == row.fault_id(); });
    if (row.active()) stored.robot.active_faults.push_back(std::move(row));
  }
  void operator()(const model::OperatorRequest& record) {
    if (!record.open) {
      const auto row =
          std::ranges::find(stored.requests, record.request_id, &v1::OperatorRequest::request_id);
      UPLINK_CHECK(row != stored.requests.end(), "what was never opened is not closed");
      return view::SetTimeMs(*row, &v1::OperatorRequest::mutable_closed_at, at_ms);
    }
    v1::OperatorRequest row;
    row.set_request_id(record.request_id);
    row.set_kind(std::string(ToText(record.kind)));
    row.set_text(record.text);
    view::SetTimeMs(row, &v1::OperatorRequest::mutable_requested_at, record.requested_at_ms);
    view::SetTimeMs(row, &v1::OperatorRequest::mutable_opened_at, at_ms);
    stored.requests.push_back(std::move(row));
  }
  template <typename Other>
  void operator()(const Other& /*no sample becomes one*/) {
    UPLINK_CHECK(false, "a record of drones");
  }
};

DroneMirror::DroneMirror(const DroneOptions& options, int seconds)
    : drone(options),
      last_(model::uncrew::kTypeRows.size() + 1),
      known_(model::uncrew::kTypeRows.size() + 1) {
  ScenarioOptions scenario;
  scenario.malformed_share = 0.5;
  scenario.faults_hz = 0.3;
  const auto idle = [](std::size_t /*line*/) { return false; };
  for (int i = 0; i < seconds; ++i) {
    for (const AvatarCall& call : drone.Second(now_us_ += kSecondUs, scenario, idle)) Take(call);
  }
  for (const AvatarCall& call : drone.Last(now_us_ += kSecondUs)) Take(call);
  Show();
}

void DroneMirror::Take(const AvatarCall& call) {
  calls.push_back(call);
  drone.account().Sends(call.number);
  ::uncrew::v1::PublishResponse answer;
  const auto type = model::uncrew::TypeOfMethod(call.method);
  UPLINK_CHECK(type.has_value(), "a method of the contract");
  const auto at = static_cast<std::size_t>(*type);
  const uncrew::Judgement judged = uncrew::Judge(*type, call.request);
  if (const model::Rejection* rejection = judged.rejection()) {
    Reject(call, *rejection);
    answer.set_outcome(::uncrew::v1::OUTCOME_REJECTED);
    answer.set_reason(static_cast<v1::RejectReason>(rejection->reason));
    answer.set_field(rejection->field);
    return drone.account().Answered(call, answer, 1, now_us_);
  }
  const storage::SampleDigest digest = uncrew::DigestOf(*type, call.request);
  const uncrew::LiveSamples::Sample sample{.value = *judged.value(),
                                           .metadata = judged.metadata,
                                           .digest = digest,
                                           .received = FromUnixMs(now_us_ / 1000),
                                           .received_steady = {}};
  const bool held = live_.IsHeld(sample);
  const auto before = uncrew::Recall(*type, last_[at]);
  const auto records = uncrew::Records::Of(judged, before ? &before->value : nullptr);
  if (std::ranges::find(known_[at], call.request) != known_[at].end()) {
    answer.set_outcome(::uncrew::v1::OUTCOME_DUPLICATE);
  } else if (!records.empty()) {
    answer.set_outcome(::uncrew::v1::OUTCOME_STORED);
    known_[at].push_back(call.request);
    last_[at] = uncrew::MemoryOf(*type, call.request);
    for (const auto& record : records) {
      std::visit(Applier{stored, now_us_ / 1000}, record);
    }
  } else {
    const bool set = model::uncrew::RowOf(*type).kind == model::uncrew::SampleKind::kDurable;
    answer.set_outcome(held || set ? ::uncrew::v1::OUTCOME_SUPERSEDED
                                   : ::uncrew::v1::OUTCOME_APPLIED);
  }
  if (!held && answer.outcome() != ::uncrew::v1::OUTCOME_DUPLICATE) live_.Apply(sample);
  drone.account().Answered(call, answer, 1, now_us_);
}

void DroneMirror::Reject(const AvatarCall& call, const model::Rejection& rejection) {
  v1::Quarantined row;
  row.set_reason(std::string(model::ToText(rejection.reason)));
  row.set_field(rejection.field);
  row.set_payload_bytes(static_cast<std::int64_t>(call.request.size()));
  row.set_source("uncrew");
  row.set_topic(call.method);
  stored.robot.quarantine.push_back(std::move(row));
}

void DroneMirror::Show() {
  v1::PresenceChange online;
  online.set_presence("online");
  view::SetTimeMs(online, &v1::PresenceChange::mutable_at, kDroneStartUs / 1000);
  stored.robot.presence.push_back(std::move(online));
  look =
      boost::json::serialize(boost::json::object{{"presence", "online"},
                                                 {"source", "uncrew"},
                                                 {"operatorRequestsOpen", live_.requests().size()},
                                                 {"uncrew", view::DroneJson(live_)}});
}

}  // namespace uplink::synthetic
