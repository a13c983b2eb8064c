#include "server/config/value.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "server/config/units.h"

namespace uplink::config {
namespace {

/// Longest part of a wrong value that a problem repeats.
constexpr std::size_t kShownBytesMax = 200;

BadValue Bad(const Setting& setting, std::string_view shown) {
  if (setting.secret) {
    return {fmt::format("the value is not allowed; it must be {}", AllowedText(setting))};
  }
  return {fmt::format("{} is not allowed; it must be {}", shown, AllowedText(setting))};
}

bool InBounds(const Setting& setting, std::uint64_t number) {
  return (number == 0 && !setting.zero.empty()) || (number >= setting.min && number <= setting.max);
}

Interpreted Bounded(const Setting& setting, std::optional<std::uint64_t> number,
                    const std::string& shown) {
  if (!number || !InBounds(setting, *number)) {
    return Bad(setting, shown);
  }
  return Value(*number);
}

Interpreted BoundedDuration(const Setting& setting, std::string_view text,
                            const std::string& shown) {
  const std::optional<milliseconds> duration = ParseDuration(text);
  if (!duration || !InBounds(setting, static_cast<std::uint64_t>(duration->count()))) {
    return Bad(setting, shown);
  }
  return Value(*duration);
}

Interpreted Chosen(const Setting& setting, std::string_view text, const std::string& shown) {
  const auto at = std::find(setting.choices.begin(), setting.choices.end(), text);
  if (at == setting.choices.end()) {
    return Bad(setting, shown);
  }
  return Value(Choice{static_cast<std::size_t>(at - setting.choices.begin())});
}

std::string Shown(std::string_view text) {
  return fmt::format("\"{}\"", PrintableUtf8(text, kShownBytesMax));
}

/// An empty text, and one behind the last comma, is an item only where items may be empty.
std::vector<std::string> SplitAtCommas(const Setting& setting, std::string_view text) {
  std::vector<std::string> items;
  while (true) {
    const std::size_t comma = std::min(text.find(','), text.size());
    items.emplace_back(text.substr(0, comma));
    if (comma == text.size()) break;
    text.remove_prefix(comma + 1);
  }
  if (items.back().empty() && !setting.empty_items) items.pop_back();
  return items;
}

Interpreted Networks(const std::vector<std::string>& items) {
  absl::StatusOr<std::vector<Network>> networks = ParseNetworks(items);
  if (!networks.ok()) return BadValue{std::string(networks.status().message())};
  return Value(*std::move(networks));
}

}  // namespace

Interpreted InterpretList(const Setting& setting, std::vector<std::string> items) {
  if (items.size() > kListItemsMax) return Bad(setting, fmt::format("{} strings", items.size()));
  for (const std::string& item : items) {
    if (std::ranges::count(items, item) > 1) {
      return BadValue{fmt::format("{} stands in it twice; write it once", Shown(item))};
    }
    const bool empty = item.empty() && !setting.empty_items;
    if (empty || item.size() > kListItemBytesMax || !IsCleanUtf8(item)) {
      return Bad(setting, Shown(item));
    }
  }
  if (setting.kind == Kind::kNetworks) return Networks(items);
  return Value(std::move(items));
}

Interpreted InterpretText(const Setting& setting, std::string_view text) {
  const std::string shown = Shown(text);
  switch (setting.kind) {
    case Kind::kSwitch:
      if (text == "true" || text == "false") {
        return Value(text == "true");
      }
      return Bad(setting, shown);
    case Kind::kCount:
      return Bounded(setting, ParseCount(text), shown);
    case Kind::kBytes:
      return Bounded(setting, ParseBytes(text), shown);
    case Kind::kDuration:
      return BoundedDuration(setting, text, shown);
    case Kind::kText:
    case Kind::kFile:
      if (!IsCleanUtf8(text)) {
        return Bad(setting, shown);
      }
      return Value(std::string(text));
    case Kind::kChoice:
      return Chosen(setting, text, shown);
    case Kind::kAddress:
      if (text.empty() && !setting.empty.empty()) return Value(ListenAddress());
      if (const std::optional<ListenAddress> address = ParseListenAddress(text);
          address && (setting.unix_socket || !IsUnix(*address))) {
        return Value(*address);
      }
      return Bad(setting, shown);
    case Kind::kList:
    case Kind::kNetworks:
      return InterpretList(setting, SplitAtCommas(setting, text));
  }
  CheckFailed(__FILE__, __LINE__, "kind", "a setting of unknown kind");
}

Interpreted InterpretInteger(const Setting& setting, std::int64_t number) {
  const std::string shown = fmt::format("{}", number);
  if (setting.kind != Kind::kCount || number < 0) {
    return Bad(setting, shown);
  }
  return Bounded(setting, static_cast<std::uint64_t>(number), shown);
}

}  // namespace uplink::config
