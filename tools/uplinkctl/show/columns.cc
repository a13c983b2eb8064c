#include "tools/uplinkctl/show/columns.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/ages.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/show/one_line.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// Percent below which a battery is called out.
constexpr double kPercentBad = 20;
constexpr double kPercentWarning = 40;

std::optional<SystemTime> TimeAt(const json::object& row, std::string_view path) {
  return FromRfc3339(TextAt(row, path));
}

/// 64-bit numbers come as texts.
std::optional<double> NumberOf(const json::value* value) {
  if (value == nullptr) return std::nullopt;
  if (const auto* text = value->if_string()) {
    char* end = nullptr;
    const std::string digits(text->data(), text->size());
    const double number = std::strtod(digits.c_str(), &end);
    if (digits.empty() || *end != '\0') return std::nullopt;
    return number;
  }
  if (!value->is_number()) return std::nullopt;
  return value->to_number<double>();
}

/// `2026-05-01 22:00:03Z`.
std::string ClockText(SystemTime time) {
  std::string text = Rfc3339(std::chrono::floor<std::chrono::seconds>(time));
  if (const std::size_t t = text.find('T'); t != std::string::npos) text[t] = ' ';
  return text;
}

std::string LengthAt(const Column& column, const json::object& row, const ColumnTerms& terms) {
  const std::size_t comma = column.member.find(',');
  const auto begin = TimeAt(row, column.member.substr(0, comma));
  if (!begin) return {};
  const auto end = TimeAt(row, column.member.substr(comma + 1));
  return LengthText(std::max(end.value_or(terms.now) - *begin, milliseconds(0)));
}

std::string ListText(const json::value& value) {
  if (const auto* by_name = value.if_object()) {
    std::string text;
    for (const auto& [name, each] : *by_name) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ",
                          std::string_view(name.data(), name.size()), ScalarText(each));
    }
    return text;
  }
  const auto* list = value.if_array();
  if (list == nullptr) return ScalarText(value);
  std::string text;
  for (const json::value& each : *list) text += (text.empty() ? "" : ", ") + ScalarText(each);
  return text;
}

std::string PlaceText(const json::value& value) {
  const auto* place = value.if_object();
  if (place == nullptr) return {};
  const auto at = [place](std::string_view name) { return NumberOf(place->if_contains(name)); };
  if (at("latitude") && at("longitude")) {
    return fmt::format("{:.5f}, {:.5f}", *at("latitude"), *at("longitude"));
  }
  if (at("x") && at("y")) return fmt::format("x {:.2f}, y {:.2f} m", *at("x"), *at("y"));
  return {};
}

Cell PercentCell(const json::value& value) {
  const auto number = NumberOf(&value);
  if (!number) return {};
  const Tone tone = *number < kPercentBad       ? Tone::kBad
                    : *number < kPercentWarning ? Tone::kWarning
                                                : Tone::kPlain;
  return {fmt::format("{:.0f} %", *number), tone};
}

std::string NumberText(const json::value& value) {
  const std::string text = ScalarText(value);
  const bool whole =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  return whole ? CountText(text) : text;
}

std::string RobotText(const std::string& ruri, const ShortNames& names) {
  if (ruri.empty()) return "-";
  const auto found = names.find(ruri);
  return found == names.end() ? ruri : found->second;
}

std::string AgeOf(const std::string& text, SystemTime now) {
  const auto time = FromRfc3339(text);
  return time ? AgeText(*time, now) : text;
}

std::string TimeOf(const std::string& text) {
  const auto time = FromRfc3339(text);
  return time ? ClockText(*time) : text;
}

Cell CellOf(const Column& column, const json::value& value, const ColumnTerms& terms) {
  switch (column.kind) {
    case Kind::kText:
    case Kind::kLength:
      return {ScalarText(value)};
    case Kind::kWord:
      return {ScalarText(value), ToneOf(ScalarText(value))};
    case Kind::kRobot:
      return {RobotText(ScalarText(value), terms.names)};
    case Kind::kAge:
      return {AgeOf(ScalarText(value), terms.now)};
    case Kind::kTime:
      return {TimeOf(ScalarText(value))};
    case Kind::kNumber:
      return {NumberText(value)};
    case Kind::kRate: {
      const auto rate = NumberOf(&value);
      return {rate ? fmt::format("{:.1f}", *rate) : ""};
    }
    case Kind::kHundredths: {
      const auto hundredths = NumberOf(&value);
      return {hundredths ? fmt::format("{:.0f} %", *hundredths / 100) : ""};
    }
    case Kind::kBytes: {
      const auto bytes = NumberOf(&value);
      return {bytes ? SizeText(*bytes) : ""};
    }
    case Kind::kYes:
      return {value.is_bool() && value.get_bool() ? "yes" : "", Tone::kWarning};
    case Kind::kList:
      return {ListText(value)};
    case Kind::kPlace:
      return {PlaceText(value)};
    case Kind::kPercent:
      return PercentCell(value);
  }
  return {};
}

bool IsRight(Kind kind) {
  return kind == Kind::kNumber || kind == Kind::kRate || kind == Kind::kHundredths ||
         kind == Kind::kBytes || kind == Kind::kPercent;
}

}  // namespace

const json::value* MemberAt(const json::object& row, std::string_view path) {
  const json::object* at = &row;
  while (true) {
    const std::size_t point = path.find('.');
    const json::value* value = at->if_contains(path.substr(0, point));
    if (value == nullptr || point == std::string_view::npos) return value;
    at = value->if_object();
    if (at == nullptr) return nullptr;
    path.remove_prefix(point + 1);
  }
}

std::string TextAt(const json::object& row, std::string_view path) {
  const json::value* value = MemberAt(row, path);
  const auto* text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::string() : std::string(text->data(), text->size());
}

Heading HeadingOf(const Column& column) {
  return {std::string(column.title), column.fit, IsRight(column.kind)};
}

Cell CellOf(const Column& column, const json::object& row, const ColumnTerms& terms) {
  if (column.kind == Kind::kLength) return {LengthAt(column, row, terms)};
  const json::value* value = MemberAt(row, column.member);
  if (value == nullptr) return {};
  Cell cell = CellOf(column, *value, terms);
  cell.text = OneLine(cell.text);
  return cell;
}

Tone ToneOf(std::string_view word) {
  constexpr std::array<std::string_view, 3> kGood = {"online", "complete", "orderly"};
  constexpr std::array<std::string_view, 9> kWarning = {
      "unknown", "minor", "warn", "paused", "blocked", "silent", "broken", "replaced", "not_read"};
  constexpr std::array<std::string_view, 9> kBad = {
      "offline",        "major",   "critical",           "error", "failed", "aborted",
      "protocol_error", "refused", "certificate_expired"};
  const auto is_in = [word](const auto& words) {
    return std::ranges::find(words, word) != words.end();
  };
  if (is_in(kGood)) return Tone::kGood;
  if (is_in(kWarning)) return Tone::kWarning;
  return is_in(kBad) ? Tone::kBad : Tone::kPlain;
}

std::string SizeText(double bytes) {
  constexpr std::array kUnits = {"KiB", "MiB", "GiB", "TiB"};
  constexpr double kNext = 1024;
  if (bytes < kNext) return fmt::format("{:.0f} B", bytes);
  std::size_t unit = 0;
  for (bytes /= kNext; bytes >= kNext && unit + 1 < kUnits.size(); bytes /= kNext) ++unit;
  return fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

std::string CountText(std::string_view digits) {
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

}  // namespace uplink::ctl
