#include "tools/uplink-fleet/twin/canonical.h"

#include <map>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

// Depth is that of what this program makes, or of what the server's answers may hold.
// NOLINTNEXTLINE(misc-no-recursion): see above
void Append(const js::value& value, std::string& text) {
  if (const js::object* object = value.if_object()) {
    std::map<std::string_view, const js::value*> members;
    for (const auto& member : *object) {
      members[{member.key().data(), member.key().size()}] = &member.value();
    }
    text += '{';
    for (const auto& [name, member] : members) {
      if (text.back() != '{') text += ',';
      text += js::serialize(js::string(name.data(), name.size())) + ":";
      Append(*member, text);
    }
    text += '}';
  } else if (const js::array* items = value.if_array()) {
    text += '[';
    for (const js::value& item : *items) {
      if (text.back() != '[') text += ',';
      Append(item, text);
    }
    text += ']';
  } else if (value.is_number()) {
    text += fmt::format("{}", value.to_number<double>());
  } else {
    text += js::serialize(value);
  }
}

}  // namespace

std::string CanonicalText(const js::value& value) {
  std::string text;
  Append(value, text);
  return text;
}

}  // namespace uplink::synthetic
