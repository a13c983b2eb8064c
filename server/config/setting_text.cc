// The texts of a setting: its names, its values, what it takes.
#include <algorithm>
#include <cctype>
#include <string_view>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "schema/base/check.h"
#include "server/config/settings.h"
#include "server/config/units.h"

namespace uplink::config {
namespace {

/// A TOML basic string. Settings hold well-formed UTF-8; control characters are escaped.
std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7F) {
      quoted += fmt::format("\\u{:04X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

constexpr const char* kMask = "***";

/// Whether a text may hold a password where a start refuses one, however its letters are written.
bool MayTellPassword(std::string_view text) {
  return text.find('%') != std::string_view::npos ||
         absl::StrContains(absl::AsciiStrToLower(std::string(text)), "pass");
}

/// A URL without the password of its user part, and without a query that may hold one.
std::string MaskedUrl(const std::string& url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string::npos) {
    return MayTellPassword(url) ? kMask : url;
  }
  const std::size_t query = url.find('?', scheme);
  if (query != std::string::npos && MayTellPassword(std::string_view(url).substr(query))) {
    return MaskedUrl(url.substr(0, query)) + "?" + kMask;
  }
  const std::size_t user = scheme + 3;
  const std::size_t at = url.substr(0, url.find('/', user)).rfind('@');
  const std::size_t colon = url.find(':', user);
  if (at == std::string::npos || at < user || colon == std::string::npos || colon > at) {
    return url;
  }
  return url.substr(0, colon + 1) + "***" + url.substr(at);
}

std::string NumberText(const Setting& setting, std::uint64_t number) {
  switch (setting.kind) {
    case Kind::kBytes:
      return BytesText(number);
    case Kind::kDuration:
      return DurationText(milliseconds(static_cast<std::int64_t>(number)));
    case Kind::kSwitch:
    case Kind::kCount:
    case Kind::kText:
    case Kind::kFile:
    case Kind::kChoice:
    case Kind::kAddress:
    case Kind::kList:
    case Kind::kNetworks:
      return fmt::format("{}", number);
  }
  CheckFailed(__FILE__, __LINE__, "kind", "a setting of unknown kind");
}

std::string RangeText(const Setting& setting, std::string_view form) {
  // Where values have a unit they are texts, 0 too.
  const bool is_text = setting.kind == Kind::kBytes || setting.kind == Kind::kDuration;
  const std::string zero =
      setting.zero.empty() ? std::string()
                           : fmt::format(", or {}: {}", is_text ? Quoted("0") : "0", setting.zero);
  return fmt::format("{} from {} to {}{}", form, NumberText(setting, setting.min),
                     NumberText(setting, setting.max), zero);
}

struct ValueTextVisitor {
  const Setting& setting;

  std::string operator()(bool on) const { return on ? "true" : "false"; }
  std::string operator()(std::uint64_t number) const {
    return setting.kind == Kind::kBytes ? Quoted(BytesText(number)) : fmt::format("{}", number);
  }
  std::string operator()(milliseconds duration) const { return Quoted(DurationText(duration)); }
  std::string operator()(const std::string& text) const {
    return Quoted(setting.secret ? MaskedUrl(text) : text);
  }
  std::string operator()(Choice choice) const { return Quoted(setting.choices[choice.index]); }
  std::string operator()(const ListenAddress& address) const { return Quoted(ToText(address)); }
  std::string operator()(const std::vector<std::string>& items) const {
    std::string list = "[";
    for (const std::string& item : items) {
      list += list.size() > 1 ? ", " : "";
      list += Quoted(item);
    }
    return list + "]";
  }
  std::string operator()(const std::vector<Network>& networks) const {
    std::vector<std::string> items;
    items.reserve(networks.size());
    for (const Network& network : networks) items.push_back(network.ToText());
    return (*this)(items);
  }
};

}  // namespace

std::string FullKey(const Setting& setting) {
  return fmt::format("{}.{}", setting.section, setting.key);
}

std::string EnvironmentName(const Setting& setting) {
  std::string name = fmt::format("UPLINKD_{}_{}", setting.section, setting.key);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == '.' ? '_' : static_cast<char>(std::toupper(c));
  });
  return name;
}

std::string ValueText(const Setting& setting, const Value& value) {
  return std::visit(ValueTextVisitor{setting}, value);
}

std::string AllowedText(const Setting& setting) {
  if (!setting.allowed.empty()) return std::string(setting.allowed);
  switch (setting.kind) {
    case Kind::kSwitch:
      return "true or false";
    case Kind::kCount:
      return RangeText(setting, "a whole number");
    case Kind::kBytes:
      return RangeText(setting, "a size such as \"64KiB\"");
    case Kind::kDuration:
      return RangeText(setting, "a duration such as \"10s\"");
    case Kind::kText:
      return "a string";
    case Kind::kFile:
      return "a path";
    case Kind::kChoice:
      return fmt::format("\"{}\"", fmt::join(setting.choices, "\" or \""));
    case Kind::kAddress:
      return "a literal address with a port, such as \"127.0.0.1:7480\" or \"[::]:7443\"" +
             (setting.unix_socket
                  ? fmt::format(", or \"unix:\" and an absolute path of at most {} bytes",
                                kSocketPathBytesMax)
                  : std::string()) +
             (setting.empty.empty() ? std::string() : fmt::format(", or \"\": {}", setting.empty));
    case Kind::kList:
      return fmt::format("a list of at most {} strings of 1 to {} bytes", kListItemsMax,
                         kListItemBytesMax);
    case Kind::kNetworks:
      return fmt::format(
          "a list of at most {} networks, such as [\"10.0.0.0/8\", \"192.0.2.7\", "
          "\"2001:db8::/32\"]",
          kListItemsMax);
  }
  CheckFailed(__FILE__, __LINE__, "kind", "a setting of unknown kind");
}

}  // namespace uplink::config
