#include "tools/uplink-fleet/robot/account.h"

#include <algorithm>

#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

// One overload for each way in which a live message is remembered.
template <typename Message>
void Remember(const Message& message, std::optional<Message>& last) {
  last = message;
}

template <typename Message>
void Remember(const Message& message, std::map<std::string, Message>& last) {
  last[KeyOf(message)] = message;
}

void Remember(const model::TelemetryExtras& extras,
              std::map<std::string, model::SensorReading>& last) {
  for (model::SensorReading reading : extras.kv) {
    if (!reading.unix_time_ms) reading.unix_time_ms = extras.unix_time_ms;
    last[reading.key] = reading;
  }
}

}  // namespace

std::uint64_t Account::Enter(const model::Body& body) {
  sent_.push_back({.row_hash = Expect(body), .seq = 0, .variant = model::VariantOf(body)});
  return sent_.size();
}

std::uint64_t Account::EnterWrong(model::RejectReason reason, std::string field) {
  sent_.push_back({});
  wrongs_[sent_.size()] = {.reason = reason, .field = std::move(field)};
  return sent_.size();
}

std::uint64_t Account::Expect(const model::Body& body) {
  return std::visit(
      Overloaded{[&](const model::Fault& fault) {
                   const v1::Fault row = RowOf(fault);
                   const std::pair key{fault.fault_id, fault.source};
                   if (fault.active) {
                     active_[key] = row;
                   } else {
                     active_.erase(key);
                   }
                   return HashOf(row);
                 },
                 [&](const model::EventTelemetry& event) { return HashOf(RowOf(event)); },
                 [&](const model::Message& message) { return HashOf(RowOf(message)); },
                 [&](const model::MissionRunStatus& report) {
                   RunExpectation& run = runs_[{report.mission_id, report.run_id}];
                   if (report.name) run.name = *report.name;
                   ++run.updates;
                   run.latest = report;
                   return std::uint64_t{0};
                 },
                 [&](const model::ShapeOp& op) {
                   if (const model::ReportedShape* shape = op.upsert()) {
                     shapes_[op.id()] = RowOf(*shape);
                     if (shape->expire_time_ms != 0) ++expiring_;
                   } else {
                     shapes_.erase(op.id());
                   }
                   return std::uint64_t{0};
                 },
                 [&](const model::ObjectOp& op) {
                   if (const model::Object* object = op.upsert()) {
                     objects_[op.id()] = RowOf(*object);
                     if (object->expires_unix_time_ms != 0) ++expiring_;
                   } else {
                     objects_.erase(op.id());
                   }
                   return std::uint64_t{0};
                 },
                 [&](const model::AgentInfo& info) {
                   agent_info_ = info;
                   return std::uint64_t{0};
                 },
                 [&](const model::CurrentSettings& settings) {
                   settings_ = settings;
                   return std::uint64_t{0};
                 },
                 [&](const model::UiCapabilities& capabilities) {
                   ui_capabilities_ = capabilities;
                   return std::uint64_t{0};
                 },
                 [](const auto& /*live*/) { return std::uint64_t{0}; }},
      body);
}

void Account::EnterLive(const model::Body& body) {
  std::visit(
      [this]<typename Message>(const Message& message) {
#define UPLINK_PART(Part, column, view, Brings, keys_max) \
  if constexpr (std::is_same_v<Message, model::Brings>) Remember(message, live_.column);
        UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
      },
      body);
}

std::uint64_t Account::good_acked() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(sent_, &SentMessage::acked));
}

void Account::GiveWay(std::uint64_t tag) {
  if (tag == 0 || tag > sent_.size()) return;
  sent_[tag - 1].gave_way = true;
  ++gave_way_;
}

bool Account::Settle(Settled settled) {
  if (const auto wrong = wrongs_.find(settled.tag); wrong != wrongs_.end()) {
    wrong->second.seq = settled.seq;
    wrong->second.acked = true;
    wrong->second.told = std::move(settled.rejection);
    return false;
  }
  if (settled.tag == 0 || settled.tag > sent_.size()) return false;
  SentMessage& message = sent_[settled.tag - 1];
  message.seq = settled.seq;
  message.acked = true;
  if (settled.rejection && good_rejected_++ == 0) {
    first_good_rejection_ = settled.rejection->detail;
  }
  return true;
}

}  // namespace uplink::synthetic
