#include "schema/uncrew/records.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "schema/json/uncrew.h"
#include "schema/model/enum_text.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;

constexpr std::int64_t kUsPerMs = 1000;

model::MessageLevel LevelOf(uc::StatusTextLevel level) {
  if (!model::IsRecognized(level) || level <= uc::StatusTextLevel::kNotice) {
    return model::MessageLevel::kInfo;
  }
  return level == uc::StatusTextLevel::kWarning ? model::MessageLevel::kWarn
                                                : model::MessageLevel::kError;
}

/// The text that people read about an alert: its drone's words, or what it is about.
std::string DescriptionOf(const uc::Alert& alert) {
  if (!alert.text.empty()) return alert.text;
  if (!alert.condition.empty()) return alert.condition;
  if (!alert.cause.empty()) return alert.cause;
  if (!alert.remaining_percent) return {};
  if (!alert.threshold_percent) return fmt::format("{:.1f} % left", *alert.remaining_percent);
  return fmt::format("{:.1f} % left, the threshold is {:.1f} %", *alert.remaining_percent,
                     *alert.threshold_percent);
}

model::Fault FaultOf(const uc::Alert& alert, std::int64_t sampled_ms, bool active) {
  const std::int64_t raised_ms = alert.raised_at_us / kUsPerMs;
  return {.unix_time_ms = active && raised_ms != 0 ? raised_ms : sampled_ms,
          .fault_id = alert.alert_id,
          .source = std::string(kFaultSource),
          .severity = alert.kind == uc::AlertKind::kFlightTermination
                          ? model::FaultSeverity::kCritical
                          : model::FaultSeverity::kMajor,
          .active = active,
          .category = model::EnumText(alert.kind),
          .description = DescriptionOf(alert),
          .suggested_action = {}};
}

model::OperatorRequest RequestOf(const uc::OperatorActionRequest& request, std::int64_t sampled_ms,
                                 bool open) {
  return {.unix_time_ms = sampled_ms,
          .request_id = request.request_id,
          .kind = request.kind,
          .text = request.text,
          .requested_at_ms = request.requested_at_us / kUsPerMs,
          .open = open};
}

const std::string& IdOf(const uc::Alert& alert) { return alert.alert_id; }
const std::string& IdOf(const uc::OperatorActionRequest& request) { return request.request_id; }

/// Calls `say` with each item that `others` lacks, by id.
template <typename Item, typename Say>
void ForEachNotIn(const std::vector<Item>& others, const std::vector<Item>& items, Say say) {
  for (const Item& item : items) {
    const bool there = std::any_of(others.begin(), others.end(),
                                   [&](const Item& other) { return IdOf(other) == IdOf(item); });
    if (!there) say(item);
  }
}

// Whether a change to it is reported: a change to "unknown" is not.
bool SaysSomething(const uc::Armed& body) { return body.is_armed.has_value(); }
bool SaysSomething(const uc::FlightMode& /*body*/) { return true; }
bool SaysSomething(const uc::UncrewFlightMode& body) { return !body.mode.empty(); }
bool SaysSomething(const uc::CurrentMissionItem& body) { return body.current || body.total; }

bool SaysTheSame(const uc::UncrewFlightMode& a, const uc::UncrewFlightMode& b) {
  return a.mode == b.mode;  // its detail may change at each moment
}
template <typename Mode>
bool SaysTheSame(const Mode& a, const Mode& b) {
  return a == b;
}

template <typename Body>
constexpr std::string_view kChangeKind{};
template <>
constexpr std::string_view kChangeKind<uc::Armed> = "armed";
template <>
constexpr std::string_view kChangeKind<uc::FlightMode> = "flightMode";
template <>
constexpr std::string_view kChangeKind<uc::UncrewFlightMode> = "uncrewFlightMode";
template <>
constexpr std::string_view kChangeKind<uc::CurrentMissionItem> = "missionItem";

template <typename Body>
concept DurableOnChange = !kChangeKind<Body>.empty();

/// Makes the records of what a value says and the one before it does not: one overload for each
/// durable type.
struct RecordMaker {
  const uc::Value& value;
  const uc::Value* before;
  std::int64_t sampled_ms;
  std::vector<std::variant<model::Body, model::OperatorRequest>> made{};

  void operator()(const uc::StatusText& body) {
    made.emplace_back(model::Message{.unix_time_ms = sampled_ms,
                                     .level = LevelOf(body.type),
                                     .message = body.text,
                                     .detail_json = {},
                                     .source_level = model::EnumText(body.type)});
  }
  void operator()(const uc::Error& /*body*/) { Event("error", json::Text(value)); }
  void operator()(const uc::ConnectionEvent& /*body*/) { Event("connection", json::Text(value)); }
  void operator()(const uc::CommandResult& /*body*/) { Event("commandResult", json::Text(value)); }

  template <DurableOnChange Mode>
  void operator()(const Mode& body) {
    const Mode* last = Before<Mode>();
    if (!SaysSomething(body) || (last != nullptr && SaysTheSame(*last, body))) return;
    Event(kChangeKind<Mode>, json::ChangeText(last != nullptr ? before : nullptr, value));
  }

  void operator()(const uc::Alerts& body) {
    const uc::Alerts* last = Before<uc::Alerts>();
    const uc::Alerts none;
    const uc::Alerts& were = last != nullptr ? *last : none;
    ForEachNotIn(body.items, were.items,
                 [&](const auto& alert) { Make(FaultOf(alert, sampled_ms, false)); });
    ForEachNotIn(were.items, body.items,
                 [&](const auto& alert) { Make(FaultOf(alert, sampled_ms, true)); });
  }
  void operator()(const uc::OperatorRequests& body) {
    const uc::OperatorRequests* last = Before<uc::OperatorRequests>();
    const uc::OperatorRequests none;
    const uc::OperatorRequests& were = last != nullptr ? *last : none;
    ForEachNotIn(body.items, were.items, [&](const auto& request) {
      made.emplace_back(RequestOf(request, sampled_ms, false));
    });
    ForEachNotIn(were.items, body.items, [&](const auto& request) {
      made.emplace_back(RequestOf(request, sampled_ms, true));
    });
  }
  template <typename Live>
  requires(uc::kKindOf<Live> == uc::SampleKind::kLive) void operator()(const Live& /*body*/) {}

 private:
  template <typename Body>
  [[nodiscard]] const Body* Before() const {
    return before == nullptr ? nullptr : std::get_if<Body>(before);
  }
  void Make(model::Body body) { made.emplace_back(std::move(body)); }
  void Event(std::string_view kind, std::string detail) {
    Make(model::EventTelemetry{
        .unix_time_ms = sampled_ms,
        .kind = model::NamedEvent{.kind = std::string(kind), .detail_json = std::move(detail)}});
  }
};

}  // namespace

std::string_view MemoryOf(uc::SampleType type, std::string_view request) {
  const bool remembered = uc::RowOf(type).kind == uc::SampleKind::kDurableOnChange ||
                          type == uc::SampleType::kAlerts ||
                          type == uc::SampleType::kOperatorRequests;
  return remembered ? request : std::string_view();
}

std::optional<Recalled> Recall(uc::SampleType type, std::string_view memory) {
  if (memory.empty()) return std::nullopt;
  Judgement judged = Judge(type, memory);
  if (auto* value = std::get_if<uc::Value>(&judged.verdict)) {
    return Recalled{std::move(*value), std::move(judged.metadata)};
  }
  return std::nullopt;
}

std::vector<DurableRecord> Records::Of(const Judgement& judged, const uc::Value* before) {
  const uc::Value* value = judged.value();
  if (value == nullptr) return {};
  RecordMaker maker{
      .value = *value, .before = before, .sampled_ms = judged.metadata.sampled_at_us / kUsPerMs};
  std::visit([&](const auto& body) { maker(body); }, *value);
  std::vector<DurableRecord> records;
  records.reserve(maker.made.size());
  for (auto& each : maker.made) {
    if (auto* body = std::get_if<model::Body>(&each)) {
      records.emplace_back(model::Record(std::move(*body), {}, {}, judged.payload_bytes));
    } else {
      records.emplace_back(std::get<model::OperatorRequest>(std::move(each)));
    }
  }
  return records;
}

}  // namespace uplink::uncrew
