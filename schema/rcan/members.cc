#include "schema/rcan/members.h"

#include <cmath>

#include "schema/json/exact.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::schema {
namespace {

namespace js = boost::json;

/// The first double above all 64-bit integers with and without a sign; both are exact.
constexpr double kSignedEnd = 9223372036854775808.0;
constexpr double kUnsignedEnd = 18446744073709551616.0;

bool IsWhole(double value) { return std::isfinite(value) && std::trunc(value) == value; }

double AsDouble(const js::value& value) {
  if (const auto* whole = value.if_int64()) return static_cast<double>(*whole);
  if (const auto* whole = value.if_uint64()) return static_cast<double>(*whole);
  return value.get_double();
}

/// The value as a signed integer if it is one of 64 bits.
std::optional<std::int64_t> AsSigned(const js::value& value) {
  if (const auto* whole = value.if_int64()) return *whole;
  if (value.is_uint64()) return std::nullopt;  // above what is signed
  const double number = value.get_double();
  if (number < -kSignedEnd || number >= kSignedEnd) return std::nullopt;
  return static_cast<std::int64_t>(number);
}

std::optional<std::uint64_t> AsUnsigned(const js::value& value) {
  if (const auto* whole = value.if_uint64()) return *whole;
  if (const auto* whole = value.if_int64()) {
    if (*whole < 0) return std::nullopt;
    return static_cast<std::uint64_t>(*whole);
  }
  const double number = value.get_double();
  if (number < 0 || number >= kUnsignedEnd) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

}  // namespace

void Members::Report(Need need, const Violation& violation) {
  if (need == Need::kMust) {
    violations_.Reject(violation);
  } else {
    violations_.Content(violation);
  }
}

void Members::ReportType(Need need, std::string_view name, const js::value& value,
                         std::string_view expected) {
  const Path field = path_.Field(name);
  Report(need, TypeMismatch(field, json::KindOf(value), expected));
}

const js::value* Members::Find(std::string_view name, Need need) {
  const js::value* value = object_.if_contains(js::string_view(name.data(), name.size()));
  if (value == nullptr && need == Need::kMust) {
    const Path field = path_.Field(name);
    violations_.Reject(MissingField(field, "is missing"));
  }
  return value;
}

bool Members::Has(std::string_view name) {
  if (Find(name, Need::kMay) != nullptr) return true;
  const Path field = path_.Field(name);
  violations_.Content(MissingField(field, "is missing"));
  return false;
}

std::optional<double> Members::Number(std::string_view name, Need need) {
  const js::value* value = Find(name, need);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number()) {
    ReportType(need, name, *value, "number");
    return std::nullopt;
  }
  const double number = AsDouble(*value);
  if (std::isfinite(number)) return number;
  const Path field = path_.Field(name);
  violations_.Reject(NotFinite(field, number));
  return std::nullopt;
}

std::optional<double> Members::NumberFrom(std::string_view name, double min) {
  const std::optional<double> number = Number(name, Need::kMay);
  if (!number || *number >= min) return number;
  const Path field = path_.Field(name);
  Report(Need::kMay, BelowZero(field, *number));
  return std::nullopt;
}

std::optional<std::int64_t> Members::Whole(std::string_view name, Need need, WholeBounds bounds) {
  const std::optional<double> number = Number(name, need);
  if (!number) return std::nullopt;
  const js::value& value = *Find(name, need);
  if (!IsWhole(*number)) {
    ReportType(need, name, value, "integer");
    return std::nullopt;
  }
  const std::optional<std::int64_t> whole = AsSigned(value);
  if (whole && *whole >= bounds.min && *whole <= bounds.max) return whole;
  const Path field = path_.Field(name);
  Report(need, OutOfRange(field, *number, static_cast<double>(bounds.min),
                          static_cast<double>(bounds.max)));
  return std::nullopt;
}

std::optional<std::uint64_t> Members::Bits(std::string_view name) {
  const std::optional<double> number = Number(name, Need::kMay);
  if (!number) return std::nullopt;
  const js::value& value = *Find(name, Need::kMay);
  if (!IsWhole(*number)) {
    ReportType(Need::kMay, name, value, "integer");
    return std::nullopt;
  }
  const std::optional<std::uint64_t> bits = AsUnsigned(value);
  if (bits) return bits;
  const Path field = path_.Field(name);
  Report(Need::kMay, OutOfRange(field, *number, 0, kUnsignedEnd));
  return std::nullopt;
}

std::optional<std::string_view> Members::String(std::string_view name, Need need) {
  const js::value* value = Find(name, need);
  if (value == nullptr) return std::nullopt;
  const js::string* text = value->if_string();
  if (text == nullptr) {
    ReportType(need, name, *value, "string");
    return std::nullopt;
  }
  return std::string_view(text->data(), text->size());
}

std::optional<std::string> Members::Text(std::string_view name, Need need, std::size_t bytes_max) {
  const std::optional<std::string_view> text = String(name, need);
  if (!text) return std::nullopt;
  const Path field = path_.Field(name);
  const TextFinding found = ReadText(field, *text, violations_.TextBytesMax(bytes_max));
  if (!found.violation) return KeptText(violations_, *text, found.controls);
  Report(need, *found.violation);
  return std::nullopt;
}

}  // namespace uplink::schema
