#include "tools/uplink-fleet/compare/live_parts.h"

#include <array>
#include <string_view>

#include <fmt/core.h>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

constexpr std::array<const char*, 8> kWhole = {"position", "rotation", "scale",      "gps",
                                               "battery",  "motors",   "driverInfo", "lastCommand"};
constexpr std::array<const char*, 3> kByKey = {"edgeHealth", "reports", "metrics"};
constexpr const char* kArrival = "receivedAtMs";

std::string_view NameOf(const js::key_value_pair& member) {
  return {member.key().data(), member.key().size()};
}

std::string WithoutArrival(const js::value& value) {
  if (!value.is_object()) return CanonicalText(value);
  js::object object = value.get_object();
  object.erase(kArrival);
  return CanonicalText(object);
}

const js::object* ObjectIn(const js::object& object, std::string_view name) {
  const js::value* value = object.if_contains({name.data(), name.size()});
  return value == nullptr ? nullptr : value->if_object();
}

void AddJoints(const js::object& by_source, std::map<std::string, std::string>& parts) {
  for (const auto& source : by_source) {
    const js::object* joints = source.value().if_object();
    if (joints == nullptr) continue;
    for (const auto& joint : *joints) {
      const js::object* channels = joint.value().if_object();
      if (channels == nullptr) continue;
      for (const auto& channel : *channels) {
        if (NameOf(channel) == kArrival) continue;
        parts[fmt::format("joints/{}/{}/{}", NameOf(source), NameOf(joint), NameOf(channel))] =
            CanonicalText(channel.value());
      }
    }
  }
}

}  // namespace

std::map<std::string, std::string> LivePartsOf(const js::object& cyberwave) {
  std::map<std::string, std::string> parts;
  for (const char* name : kWhole) {
    if (const js::value* value = cyberwave.if_contains(name)) parts[name] = WithoutArrival(*value);
  }
  for (const char* name : kByKey) {
    const js::object* by_key = ObjectIn(cyberwave, name);
    if (by_key == nullptr) continue;
    for (const auto& member : *by_key) {
      parts[fmt::format("{}/{}", name, NameOf(member))] = WithoutArrival(member.value());
    }
  }
  if (const js::object* joints = ObjectIn(cyberwave, "joints")) AddJoints(*joints, parts);
  return parts;
}

}  // namespace uplink::synthetic
