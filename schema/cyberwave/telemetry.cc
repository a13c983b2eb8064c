#include <optional>
#include <utility>

#include "schema/cyberwave/detail.h"
#include "schema/cyberwave/families.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using model::cyberwave::Body;
using model::cyberwave::Event;
using model::cyberwave::Mark;
using model::cyberwave::MarkKind;
using model::cyberwave::Report;
using model::cyberwave::ReportKind;
using schema::Path;

constexpr std::string_view kData = "data";
constexpr std::string_view kLevel = "level";

/// What a member says if it is a text, before anything is judged.
std::string_view WordOf(const Reader& in, std::string_view name) {
  const js::value* value = in.Find(name);
  if (value == nullptr || !value->is_string()) return {};
  return FromBoost(value->get_string());
}

/// True for messages that say their type by `telemetry_type` alone.
bool IsOfCategory(const Reader& in) {
  return in.Find("type") == nullptr && in.Find("telemetry_type") != nullptr;
}

Body MarkOf(Reader& in, js::object& object, MarkKind kind) {
  Mark mark;
  mark.kind = kind;
  mark.sensor = in.Text("sensor", schema::kIdBytesMax);
  mark.recording_boundary = in.Flag("recording_boundary").value_or(false);
  mark.detail = DetailOf(object, in.violations());
  return mark;
}

void CheckErrors(Reader& data) {
  const js::array* errors = data.List("errors", Need::kMay);
  if (errors == nullptr || errors->size() <= kErrorsMax) return;
  const Path field = data.path().Field("errors");
  data.violations().Reject(schema::TooManyItems(field, errors->size(), kErrorsMax, "errors"));
}

/// The level as it is kept, in the object too: a detail shows no absurd one.
std::optional<double> BatteryPercentOf(Reader& data, js::object& object) {
  const std::optional<double> percent = data.Percent(kLevel);
  if (data.Find(kLevel) == nullptr) return std::nullopt;
  js::value& shown = object[ToBoost(kLevel)];
  if (percent) {
    shown = *percent;
  } else {
    shown = nullptr;
  }
  return percent;
}

Body CategoryOf(Reader& in, js::object& object) {
  Report report;
  report.kind = ReportKind::kTelemetry;
  report.name = in.Text("telemetry_type", schema::kNameBytesMax, Need::kMust);
  if (in.Object(kData, Need::kMay) != nullptr) {
    js::object& content = object.at(ToBoost(kData)).get_object();
    const Path path = in.path().Field(kData);
    Reader data(content, path, in.violations());
    CheckErrors(data);
    if (report.name == "battery") {
      report.battery_charging = data.Flag("charging");
      report.battery_percent = BatteryPercentOf(data, content);
    }
  }
  report.detail = DetailIn(object, kData, in.violations());
  return report;
}

Body WholeReport(Reader& in, js::object& object, ReportKind kind) {
  Report report;
  report.kind = kind;
  report.name = in.Text("type", schema::kNameBytesMax, Need::kMust);
  report.detail = DetailOf(object, in.violations());
  return report;
}

std::optional<ReportKind> ReportKindOf(std::string_view type) {
  if (type == "motor_status") return ReportKind::kMotorStatus;
  if (type == "driver_info") return ReportKind::kDriverInfo;
  return std::nullopt;
}

}  // namespace

bool IsReport(const Reader& in) {
  return IsOfCategory(in) || ReportKindOf(WordOf(in, "type")).has_value();
}

bool IsMark(const Reader& in) {
  return model::cyberwave::MarkKindFromText(WordOf(in, "type")).has_value();
}

Body ReadTelemetry(Reader& in, js::object& object) {
  if (IsOfCategory(in)) return CategoryOf(in, object);
  const std::string_view type = WordOf(in, "type");
  if (const std::optional<ReportKind> kind = ReportKindOf(type)) {
    return WholeReport(in, object, *kind);
  }
  if (const std::optional<MarkKind> kind = model::cyberwave::MarkKindFromText(type)) {
    return MarkOf(in, object, *kind);
  }
  if (type == "driver_log") return ReadDriverLog(in, object);
  Event event;
  event.type = in.Text("type", schema::kNameBytesMax, Need::kMust);
  event.source = in.Text("sender", schema::kNameBytesMax);
  event.detail = DetailOf(object, in.violations());
  return event;
}

bool IsRobotState(const Reader& in) { return WordOf(in, "event_type") == "robot_state"; }

Body ReadEvent(Reader& in, js::object& object) {
  const bool state = IsRobotState(in);
  std::string type = in.Text("event_type", schema::kNameBytesMax, Need::kMust);
  if (state) {
    Report report;
    report.kind = ReportKind::kRobotState;
    report.name = std::move(type);
    report.detail = DetailIn(object, kData, in.violations());
    return report;
  }
  Event event;
  event.type = std::move(type);
  event.source = in.Text("source", schema::kNameBytesMax);
  event.detail = DetailOf(object, in.violations());
  return event;
}

}  // namespace uplink::cyberwave
