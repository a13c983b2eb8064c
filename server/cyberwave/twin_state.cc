#include "server/cyberwave/twin_state.h"

#include <map>
#include <utility>
#include <variant>

#include "schema/base/one_of.h"
#include "server/cyberwave/held_bytes.h"

namespace uplink::cyberwave {
namespace {

namespace cw = model::cyberwave;

/// One message, without its body.
struct Context {
  TopicKind topic;
  const cw::Head& head;
  Stamp stamp;
  SessionNumber session = 0;
  std::size_t payload_bytes = 0;

  [[nodiscard]] std::int64_t unix_time_ms() const {
    constexpr std::int64_t kUsPerMs = 1000;
    return head.timestamp_us / kUsPerMs;
  }
};

/// Whether the message is the latest of its session for the value that these are the times of.
bool IsLatest(SessionTimes& times, const Context& context) {
  return times.Take(context.session, context.stamp.timestamp_us);
}

template <typename T>
Outcome Keep(std::optional<Held<T>>& held, T&& value, const Context& context) {
  if (!held) held.emplace();
  if (!IsLatest(held->times, context)) return Outcome::kSuperseded;
  held->value = std::forward<T>(value);
  held->source = context.head.source;
  held->stamp = context.stamp;
  return Outcome::kApplied;
}

template <typename T>
std::size_t ItemBytes(const std::string& key, const Held<T>& held) {
  // Key, value and the places of both in a table.
  constexpr std::size_t kTableBytes = 96;
  return sizeof(held) + kTableBytes + HeldBytes(key) + HeldBytes(held.source.text) +
         HeldBytes(held.value);
}

/// How many keys were evicted; empty if the table's value is later.
template <typename Table, typename T>
std::optional<std::size_t> KeepIn(Table& table, const std::string& key, T&& value,
                                  const Context& context) {
  Held<std::decay_t<T>> held;
  if (const auto* before = table.Find(key)) held.times = before->times;
  if (!IsLatest(held.times, context)) return std::nullopt;
  held.value = std::forward<T>(value);
  held.source = context.head.source;
  held.stamp = context.stamp;
  const std::size_t bytes = ItemBytes(key, held);
  return table.Put(key, std::move(held), bytes);
}

Applied Only(Outcome outcome) {
  Applied applied;
  applied.outcome = outcome;
  return applied;
}

Applied Stored(DurableRecord&& record) {
  Applied stored = Only(Outcome::kStored);
  stored.records.push_back(std::move(record));
  return stored;
}

std::size_t BytesOf(const std::vector<cw::Metric>& metrics) {
  std::size_t held = metrics.capacity() * sizeof(cw::Metric) + kAllocationBytes;
  for (const cw::Metric& metric : metrics) held += HeldBytes(metric);
  return held;
}

}  // namespace

struct TwinState::Applier {
  TwinState& state;
  TwinParts& parts;
  const Context& context;

  Applied operator()(cw::Position&& value) {
    return Only(Keep(parts.position, std::move(value), context));
  }
  Applied operator()(cw::Rotation&& value) {
    return Only(Keep(parts.rotation, std::move(value), context));
  }
  Applied operator()(cw::Scale&& value) {
    return Only(Keep(parts.scale, std::move(value), context));
  }
  Applied operator()(cw::Gps&& value) { return Only(Keep(parts.gps, std::move(value), context)); }
  Applied operator()(cw::BatteryStatus&& value) {
    return Only(Keep(parts.battery, std::move(value), context));
  }

  Applied operator()(cw::Joints&& joints) {
    parts.observed.CountSetpoints(joints.setpoints);
    const std::optional<JointGroup> group = JointGroupOf(context.head.source.type);
    if (!group || (joints.joints.empty() && joints.setpoints > 0)) {
      parts.observed.Count(context.topic);
      return Only(Outcome::kObserved);
    }
    JointTable::Taken taken = parts.joints.Take(joints.joints, {.group = *group,
                                                                .source = context.head.source,
                                                                .stamp = context.stamp,
                                                                .session = context.session});
    const bool old = taken.applied == 0 && taken.superseded > 0;
    return {.outcome = old ? Outcome::kSuperseded : Outcome::kApplied,
            .records = {},
            .dropped = std::move(taken.dropped),
            .without_room = taken.without_room};
  }

  Applied operator()(cw::Metrics&& metrics) {
    if (!IsLatest(state.metrics_times_, context)) return Only(Outcome::kSuperseded);
    // Without a list of errors there is no error.
    const std::vector<std::string> none;
    const auto& errors = metrics.errors ? *metrics.errors : none;
    Applied applied = Only(Outcome::kApplied);
    for (model::Fault& fault : state.faults_.Take(errors, context.unix_time_ms())) {
      applied.outcome = Outcome::kStored;
      applied.records.push_back(Records::Of(std::move(fault), context.payload_bytes));
    }
    std::map<std::string, std::vector<cw::Metric>> by_category;
    for (cw::Metric& metric : metrics.metrics) {
      by_category[metric.category].push_back(std::move(metric));
    }
    for (auto& [category, values] : by_category) {
      MetricCategory held{
          .value = std::move(values), .source = context.head.source, .stamp = context.stamp};
      const std::size_t bytes = sizeof(held) + 2 * HeldBytes(category) +
                                HeldBytes(held.source.text) + BytesOf(held.value);
      state.keys_evicted_ += parts.metrics.Put(category, std::move(held), bytes);
    }
    return applied;
  }

  Applied operator()(cw::EdgeHealth&& health) {
    const std::string edge_id = health.edge_id;
    return InTable(KeepIn(parts.edges, edge_id, std::move(health), context));
  }

  Applied operator()(cw::Report&& report) {
    report.detail.shrink_to_fit();
    switch (report.kind) {
      case cw::ReportKind::kMotorStatus:
        return Only(Keep(parts.motors, std::move(report), context));
      case cw::ReportKind::kDriverInfo:
        return Only(Keep(parts.driver_info, std::move(report), context));
      case cw::ReportKind::kTelemetry:
      case cw::ReportKind::kRobotState:
        break;
    }
    const std::string name = report.name;
    return InTable(KeepIn(parts.reports, name, std::move(report), context));
  }

  Applied operator()(cw::CommandHead&& head) {
    parts.observed.Take(context.topic, head, context.head.source, context.stamp);
    return Only(Outcome::kObserved);
  }
  Applied operator()(cw::Commanded&& commanded) {
    parts.observed.Count(context.topic);
    parts.observed.CountSetpoints(commanded.setpoints);
    return Only(Outcome::kObserved);
  }
  Applied operator()(cw::Signalling&& /*secret*/) {
    parts.observed.Count(context.topic);
    return Only(Outcome::kObserved);
  }
  Applied operator()(cw::Media&& media) {
    parts.observed.CountMedia(context.topic, media.bytes);
    return Only(Outcome::kObserved);
  }

  /// These are durable, and became a record, or are not a twin's.
  template <OneOf<cw::Ignored, cw::Mark, cw::Event, cw::DriverLog, cw::RunStatus, cw::ScopeUpdate,
                  cw::Ping>
                Other>
  Applied operator()(Other&& /*body*/) {
    return Only(Outcome::kIgnored);
  }

 private:
  Applied InTable(const std::optional<std::size_t>& evicted) {
    if (!evicted) return Only(Outcome::kSuperseded);
    state.keys_evicted_ += *evicted;
    return Only(Outcome::kApplied);
  }
};

std::size_t TwinState::RecordsAtMost(const Judgement& judgement) const {
  const cw::Body* body = judgement.body();
  if (body == nullptr) return 0;
  if (const auto* metrics = std::get_if<cw::Metrics>(body)) {
    return metrics->errors ? faults_.CountChanges(*metrics->errors) : faults_.active().size();
  }
  return judgement.message_class == MessageClass::kDurable ? 1 : 0;
}

std::size_t TwinState::held_bytes() const {
  return sizeof(TwinState) - sizeof(TwinParts) + HeldBytes(parts_) + HeldBytes(faults_);
}

Applied TwinState::Apply(Judgement&& judgement, const Arrival& arrival) {
  auto* body = std::get_if<cw::Body>(&judgement.verdict);
  if (body == nullptr) return Only(Outcome::kRejected);
  if (!IsOfTwin(judgement.topic.kind)) return {};
  const cw::Head& head = judgement.head;
  const Context context{.topic = judgement.topic.kind,
                        .head = head,
                        .stamp = {.timestamp_us = head.timestamp_us, .arrived = arrival},
                        .session = SessionNumberOf(head.session_id),
                        .payload_bytes = judgement.payload_bytes};
  if (const auto* mark = std::get_if<cw::Mark>(body)) {
    parts_.sessions.Take(*mark, head.session_id, context.stamp);
  } else {
    parts_.sessions.Touch(head.session_id);
  }
  if (std::optional<DurableRecord> record = Records::Take(judgement)) {
    return Stored(*std::move(record));
  }
  return std::visit(Applier{*this, parts_, context}, std::move(*body));
}

void TwinState::DropTable(TwinTable table) {
  switch (table) {
    case TwinTable::kJoints:
      for (std::size_t group = 0; group < kJointGroups; ++group) {
        keys_evicted_ += parts_.joints.Of(static_cast<JointGroup>(group)).size();
      }
      parts_.joints = {};
      return;
    case TwinTable::kMetrics:
      keys_evicted_ += parts_.metrics.size();
      parts_.metrics = {};
      return;
    case TwinTable::kEdges:
      keys_evicted_ += parts_.edges.size();
      parts_.edges = {};
      return;
    case TwinTable::kReports:
      keys_evicted_ += parts_.reports.size();
      parts_.reports = {};
      return;
    case TwinTable::kMotors:
      parts_.motors.reset();
      return;
    case TwinTable::kDriverInfo:
      parts_.driver_info.reset();
      return;
    case TwinTable::kSessions:
      parts_.sessions = {};
      return;
  }
}

Applied ApplyToNoRobot(Judgement&& judgement) {
  if (judgement.rejection() != nullptr) return Only(Outcome::kRejected);
  std::optional<DurableRecord> record = Records::Take(judgement);
  return record ? Stored(*std::move(record)) : Only(Outcome::kIgnored);
}

}  // namespace uplink::cyberwave
