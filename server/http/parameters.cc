#include "server/http/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <fmt/format.h>

#include "schema/base/rfc3339.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

Parameters::Parameters(std::string_view query) {
  while (!query.empty() && !problem_) {
    const std::size_t end = query.find('&');
    AddItem(query.substr(0, end));
    query = end == std::string_view::npos ? "" : query.substr(end + 1);
  }
}

void Parameters::AddItem(std::string_view item) {
  if (item.empty()) return;
  const std::size_t equals = item.find('=');
  std::optional<std::string> name = PercentDecode(item.substr(0, equals));
  std::optional<std::string> value =
      equals == std::string_view::npos ? std::string() : PercentDecode(item.substr(equals + 1));
  if (!name || !value) {
    Reject(item.substr(0, equals), "a % must be followed by two hex digits other than 00");
    return;
  }
  const auto repeats = static_cast<std::size_t>(
      std::ranges::count_if(items_, [&](const Item& each) { return each.name == *name; }));
  if (repeats == 0) ++names_;
  if (repeats == kRepeatsMax) {
    Reject(*name, fmt::format("is given more than {} times", kRepeatsMax));
  } else if (names_ > kParametersMax) {
    Reject(*name, fmt::format("is one parameter too many: at most {}", kParametersMax));
  } else {
    items_.push_back({std::move(*name), std::move(*value)});
  }
}

const std::string* Parameters::Find(std::string_view name) {
  taken_.emplace_back(name);
  const std::string* found = nullptr;
  for (Item& item : items_) {
    if (item.name != name) continue;
    if (item.read) continue;
    item.read = true;
    if (found != nullptr) Reject(name, "is given twice");
    found = &item.value;
  }
  return found;
}

const std::string* Parameters::FindSome(std::string_view name) {
  const std::string* value = Find(name);
  if (value == nullptr || !value->empty()) return value;
  RejectUse(name, "is empty: give it a value, or leave it out");
  return nullptr;
}

std::string Parameters::Text(std::string_view name) {
  const std::string* value = FindSome(name);
  return value == nullptr ? std::string() : *value;
}

std::string Parameters::TextOrEmpty(std::string_view name) {
  const std::string* value = Find(name);
  return value == nullptr ? std::string() : *value;
}

bool Parameters::Flag(std::string_view name) {
  const std::string* value = FindSome(name);
  if (value == nullptr) return false;
  if (*value != "true" && *value != "false") Reject(name, "must be true or false");
  return *value == "true";
}

std::optional<bool> Parameters::MaybeFlag(std::string_view name) {
  const std::string* value = FindSome(name);
  if (value == nullptr) return std::nullopt;
  if (*value != "true" && *value != "false") Reject(name, "must be true or false");
  return *value == "true";
}

std::vector<double> Parameters::Decimals(std::string_view name, std::size_t count) {
  std::vector<double> numbers;
  const std::string* value = FindSome(name);
  if (value == nullptr) return numbers;
  std::string_view rest = *value;
  for (bool more = true; more;) {
    const std::size_t end = rest.find(',');
    more = end != std::string_view::npos;
    const std::optional<double> number = ParseNumber<double>(rest.substr(0, end));
    if (number && std::isfinite(*number)) numbers.push_back(*number);
    if (!number || !std::isfinite(*number) || numbers.size() > count) break;
    if (more) rest.remove_prefix(end + 1);
    if (!more && numbers.size() == count) return numbers;
  }
  Reject(name, count == 1 ? std::string("must be a number")
                          : fmt::format("must be {} numbers between commas", count));
  return {};
}

std::uint32_t Parameters::Number(std::string_view name, std::uint32_t absent, std::uint32_t max) {
  const std::string* value = FindSome(name);
  if (value == nullptr) return absent;
  const std::optional<std::uint32_t> number = ParseNumber<std::uint32_t>(*value);
  if (number && *number >= 1 && *number <= max) return *number;
  Reject(name, fmt::format("must be a number from 1 to {}", max));
  return absent;
}

std::optional<SystemTime> Parameters::Time(std::string_view name) {
  const std::string* value = FindSome(name);
  if (value == nullptr) return std::nullopt;
  const std::optional<SystemTime> time = FromRfc3339(*value);
  if (!time) Reject(name, "must be a time of RFC 3339, such as 2026-05-01T12:00:00Z");
  return time;
}

std::vector<std::string> Parameters::Texts(std::string_view name) {
  taken_.emplace_back(name);
  std::vector<std::string> texts;
  for (Item& item : items_) {
    if (item.name != name) continue;
    item.read = true;
    if (item.value.empty()) RejectUse(name, "is empty: give it a value, or leave it out");
    texts.push_back(item.value);
  }
  return texts;
}

std::vector<std::string> Parameters::Words(std::string_view name) {
  std::vector<std::string> words;
  const std::string* value = FindSome(name);
  std::string_view rest = value == nullptr ? std::string_view() : std::string_view(*value);
  while (!rest.empty()) {
    const std::size_t end = rest.find(',');
    if (end != 0) words.emplace_back(rest.substr(0, end));
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  return words;
}

void Parameters::Reject(std::string_view name, std::string message) {
  if (!problem_) problem_ = BadParameter{std::string(name), std::move(message)};
}

void Parameters::RejectUse(std::string_view name, std::string message) {
  if (problem_) return;
  Reject(name, std::move(message));
  lists_taken_ = true;
}

std::optional<BadParameter> Parameters::Problem() {
  for (const Item& item : items_) {
    if (!item.read) RejectUse(item.name, "is not a parameter of this path");
  }
  if (std::exchange(lists_taken_, false)) {
    problem_->message += taken_.empty()
                             ? std::string(", which takes none")
                             : fmt::format("; this path takes {}", fmt::join(taken_, ", "));
  }
  return problem_;
}

std::uint32_t ReadPageSize(Parameters& parameters) {
  return parameters.Number("pageSize", storage::kPageSizeDefault, storage::kPageSizeMax);
}

}  // namespace uplink::http
