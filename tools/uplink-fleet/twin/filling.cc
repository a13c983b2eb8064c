#include "tools/uplink-fleet/twin/filling.h"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

std::optional<double> NumberOf(std::string_view text) {
  double number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// A number drawn as `LOW..HIGH` or `LOW..HIGH#` says; nothing for another text.
std::optional<js::value> Drawn(std::string_view text, Seeded& chance) {
  const std::size_t dots = text.find("..");
  if (dots == std::string_view::npos) return std::nullopt;
  const bool whole = text.ends_with('#');
  const auto low = NumberOf(text.substr(0, dots));
  const auto high = NumberOf(text.substr(dots + 2, text.size() - dots - 2 - (whole ? 1 : 0)));
  if (!low || !high) return std::nullopt;
  if (!whole) return js::value(chance.Between(*low, *high));
  const auto count = static_cast<std::size_t>(*high - *low) + 1;
  return js::value(static_cast<std::int64_t>(*low) +
                   static_cast<std::int64_t>(chance.Below(count)));
}

/// One of the texts between bars.
std::string_view OneOf(std::string_view text, Seeded& chance) {
  std::vector<std::string_view> texts;
  for (std::size_t bar = text.find('|'); bar != std::string_view::npos; bar = text.find('|')) {
    texts.push_back(text.substr(0, bar));
    text.remove_prefix(bar + 1);
  }
  if (texts.empty()) return text;
  texts.push_back(text);
  return texts[chance.Below(texts.size())];
}

}  // namespace

std::string Replaced(std::string text, std::string_view token, std::string_view with) {
  for (std::size_t at = text.find(token); at != std::string::npos; at = text.find(token, at)) {
    text.replace(at, token.size(), with);
    at += with.size();
  }
  return text;
}

// NOLINTNEXTLINE(misc-no-recursion): the depth is that of this program's own tables
void FillTexts(js::value& value, Seeded& chance,
               const std::function<std::string(const std::string&)>& named) {
  if (js::object* object = value.if_object()) {
    for (auto& member : *object) FillTexts(member.value(), chance, named);
  } else if (js::array* items = value.if_array()) {
    for (js::value& item : *items) FillTexts(item, chance, named);
  } else if (const js::string* found = value.if_string()) {
    const std::string_view text{found->data(), found->size()};
    auto number = Drawn(text, chance);
    value =
        number ? *std::move(number) : js::value(JsonText(named(std::string(OneOf(text, chance)))));
  }
}

}  // namespace uplink::synthetic
