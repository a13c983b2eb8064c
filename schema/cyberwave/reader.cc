#include "schema/cyberwave/reader.h"

#include <cmath>

#include "schema/json/exact.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using schema::Path;
using schema::Violation;
using schema::Violations;

/// From here on not every whole number is a double.
constexpr double kWholeMax = 9007199254740992.0;
constexpr double kUsPerSecond = 1e6;
constexpr std::int64_t kUsPerMs = 1000;

}  // namespace

void Reader::Report(Need need, const Violation& violation) {
  if (need == Need::kMust) {
    violations_.Reject(violation);
  } else {
    violations_.Content(violation);
  }
}

void Reader::ReportType(std::string_view name, Need need, const js::value& value,
                        std::string_view expected) {
  const Path field = path_.Field(name);
  Report(need, schema::TypeMismatch(field, json::KindOf(value), expected));
}

void Reader::Missing(std::string_view name, Need need, std::string_view what) {
  const Path field = path_.Field(name);
  Report(need, schema::MissingField(field, what));
}

const js::value* Reader::Find(std::string_view name) const {
  const js::value* value = object_.if_contains(ToBoost(name));
  return value == nullptr || value->is_null() ? nullptr : value;
}

const js::value* Reader::Wanted(std::string_view name, Need need) {
  const js::value* value = Find(name);
  if (value == nullptr && need == Need::kMust) Missing(name, need);
  return value;
}

const js::object* Reader::Object(std::string_view name, Need need) {
  const js::value* value = Wanted(name, need);
  if (value == nullptr) return nullptr;
  if (!value->is_object()) ReportType(name, need, *value, "object");
  return value->if_object();
}

const js::array* Reader::List(std::string_view name, Need need) {
  const js::value* value = Wanted(name, need);
  if (value == nullptr) return nullptr;
  if (!value->is_array()) ReportType(name, need, *value, "array");
  return value->if_array();
}

std::optional<double> Reader::Number(std::string_view name, Need need) {
  const js::value* value = Wanted(name, need);
  if (value == nullptr) return std::nullopt;
  const std::optional<double> number = json::NumberOf(*value);
  if (!number) {
    ReportType(name, need, *value, "number");
    return std::nullopt;
  }
  if (std::isfinite(*number)) return number;
  const Path field = path_.Field(name);
  Report(need, schema::NotFinite(field, *number));
  return std::nullopt;
}

std::optional<double> Reader::NumberIn(std::string_view name, schema::Bounds bounds, Need need) {
  const std::optional<double> number = Number(name, need);
  if (!number || (*number >= bounds.min && *number <= bounds.max)) return number;
  const Path field = path_.Field(name);
  Report(need, schema::OutOfRange(field, *number, bounds.min, bounds.max));
  return std::nullopt;
}

std::optional<double> Reader::NotNegative(std::string_view name) {
  const std::optional<double> number = Number(name);
  if (!number || *number >= 0) return number;
  const Path field = path_.Field(name);
  violations_.Content(schema::BelowZero(field, *number));
  return std::nullopt;
}

std::optional<double> Reader::Percent(std::string_view name) {
  const std::optional<double> number = Number(name);
  if (!number) return std::nullopt;
  const Path field = path_.Field(name);
  return PercentOf(violations_, field, *number);
}

std::optional<std::uint64_t> Reader::Count(std::string_view name) {
  const std::optional<double> number = NumberIn(name, {.min = 0, .max = kWholeMax});
  if (!number) return std::nullopt;
  if (std::trunc(*number) == *number) return static_cast<std::uint64_t>(*number);
  ReportType(name, Need::kMay, *Find(name), "integer");
  return std::nullopt;
}

std::optional<bool> Reader::Flag(std::string_view name) {
  const js::value* value = Find(name);
  if (value == nullptr) return std::nullopt;
  if (const bool* flag = value->if_bool()) return *flag;
  ReportType(name, Need::kMay, *value, "boolean");
  return std::nullopt;
}

std::string Reader::Text(std::string_view name, std::size_t bytes_max, Need need) {
  const js::value* value = Wanted(name, need);
  if (value == nullptr) return {};
  const js::string* text = value->if_string();
  if (text == nullptr) {
    ReportType(name, need, *value, "string");
    return {};
  }
  const Path field = path_.Field(name);
  if (text->empty() && need == Need::kMust) {
    violations_.Reject(schema::MissingField(field, "is empty"));
    return {};
  }
  const schema::TextFinding found =
      schema::ReadText(field, {text->data(), text->size()}, bytes_max);
  if (found.violation) {
    Report(need, *found.violation);
    return {};
  }
  return schema::KeptText(violations_, {text->data(), text->size()}, found.controls);
}

std::int64_t Reader::TimeUs(std::string_view name) {
  const js::value* value = Find(name);
  if (value == nullptr) return 0;
  return TimeUsOf(violations_, json::NumberOf(*value).value_or(-1));
}

std::int64_t TimeUsOf(Violations& violations, double seconds) {
  const double us = std::round(seconds * kUsPerSecond);
  // Also false for what is not finite.
  if (us >= 0 && us < static_cast<double>(schema::kTimeMsEnd * kUsPerMs)) {
    return static_cast<std::int64_t>(us);
  }
  violations.CountUnknownTime();
  return 0;
}

std::optional<double> PercentOf(Violations& violations, const Path& path, double value) {
  constexpr schema::Bounds kNoise = {.min = -schema::kPercentSlack,
                                     .max = schema::kPercentMax + schema::kPercentSlack};
  const std::optional<double> kept = schema::InRange(violations, path, value, kNoise);
  if (!kept) return std::nullopt;
  if (*kept <= 0) return 0.0;  // also -0
  return *kept > schema::kPercentMax ? schema::kPercentMax : *kept;
}

std::optional<double> NumberOf(Violations& violations, const Path& path, const js::value& value) {
  const std::optional<double> number = json::NumberOf(value);
  if (!number) {
    violations.Content(schema::TypeMismatch(path, json::KindOf(value), "number"));
    return std::nullopt;
  }
  return schema::Finite(violations, path, *number);
}

}  // namespace uplink::cyberwave
