#include "tools/uplink-fleet/compare/compare_twin_live.h"

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "schema/json/exact.h"
#include "tools/uplink-fleet/compare/compare_live.h"
#include "tools/uplink-fleet/compare/row_set.h"
#include "tools/uplink-fleet/robot/rows.h"
#include "tools/uplink-fleet/twin/canonical.h"
#include "tools/uplink-fleet/twin/live_values.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// Bytes of a value that are shown of a difference.
constexpr std::size_t kShownBytes = 120;

constexpr std::array<const char*, 8> kWhole = {"position", "rotation", "scale",      "gps",
                                               "battery",  "motors",   "driverInfo", "lastCommand"};
constexpr std::array<const char*, 3> kByKey = {"edgeHealth", "reports", "metrics"};
constexpr const char* kArrival = "receivedAt";

std::string_view NameOf(const js::key_value_pair& member) {
  return {member.key().data(), member.key().size()};
}

std::string_view TextIn(const js::object& object, const char* name) {
  const js::value* value = object.if_contains(name);
  if (value == nullptr || !value->is_string()) return {};
  return {value->get_string().data(), value->get_string().size()};
}

/// Empty if there is none.
js::object ObjectIn(const js::object& object, std::string_view name) {
  const js::value* value = object.if_contains({name.data(), name.size()});
  const js::object* found = value == nullptr ? nullptr : value->if_object();
  return found == nullptr ? js::object() : *found;
}

std::string WithoutArrival(const js::value& value) {
  if (!value.is_object()) return CanonicalText(value);
  js::object object = value.get_object();
  object.erase(kArrival);
  return CanonicalText(object);
}

std::string Cut(const std::string& path, const std::string& text) {
  return (path + ": " + text).substr(0, kShownBytes);
}

void CompareParts(const std::string& ruri, const SentParts& sent, const js::object& cyberwave,
                  Findings& findings) {
  RowSet parts(Thing::kTwinLive, ruri, findings);
  for (const auto& [path, text] : sent) {
    parts.Expect(path, {.content = HashOf(text), .shown = Cut(path, text)});
  }
  for (const auto& [path, text] : LivePartsOf(cyberwave)) {
    parts.Find(path, HashOf(text), [&path = path, &text = text] { return Cut(path, text); });
  }
  parts.Finish();
}

std::string SessionText(std::optional<bool> connected, std::optional<bool> telemetry) {
  const auto text = [](std::optional<bool> flag) { return !flag ? "?" : *flag ? "yes" : "no"; };
  return fmt::format("connected {}, telemetry {}", text(connected), text(telemetry));
}

std::string SessionText(const js::object& session) {
  const auto flag = [&session](const char* name) -> std::optional<bool> {
    const js::value* value = session.if_contains(name);
    if (value == nullptr || !value->is_bool()) return std::nullopt;
    return value->get_bool();
  };
  return SessionText(flag("connected"), flag("telemetry"));
}

void CompareSessions(const std::string& ruri, Side side, const TwinAccount& account,
                     const js::object& found, Findings& findings) {
  for (const auto& [id, session] : account.sessions()) {
    if (session.side != side) continue;
    const std::string expected = SessionText(session.connected, session.telemetry);
    const std::string shown =
        found.contains(id) ? SessionText(ObjectIn(found, id)) : "no such session";
    findings.Check(Thing::kTwinSessions, ruri, shown == expected,
                   fmt::format("{}: {}", id, expected), shown);
  }
}

}  // namespace

std::map<std::string, std::string> LivePartsOf(const js::object& cyberwave) {
  std::map<std::string, std::string> parts;
  for (const char* name : kWhole) {
    if (const js::value* value = cyberwave.if_contains(name)) parts[name] = WithoutArrival(*value);
  }
  for (const char* name : kByKey) {
    for (const auto& member : ObjectIn(cyberwave, name)) {
      parts[fmt::format("{}/{}", name, NameOf(member))] = WithoutArrival(member.value());
    }
  }
  const js::object sources = ObjectIn(cyberwave, "joints");
  for (const auto& source : sources) {
    const js::object joints = ObjectIn(sources, NameOf(source));
    for (const auto& joint : joints) {
      for (const auto& channel : ObjectIn(joints, NameOf(joint))) {
        if (NameOf(channel) == kArrival) continue;
        parts[fmt::format("joints/{}/{}/{}", NameOf(source), NameOf(joint), NameOf(channel))] =
            CanonicalText(channel.value());
      }
    }
  }
  return parts;
}

void CompareTwinLive(const TwinScript& twin, const TwinLook& look, Findings& findings) {
  for (const Side side : {Side::kReal, Side::kSim}) {
    const std::string& ruri = twin.ids().RuriOf(side);
    const std::string& text = look.at(static_cast<std::size_t>(side));
    findings.Check(Thing::kTwinSecrets, ruri, text.find(kSecret) == std::string::npos,
                   "no secret of signalling or commands", "one");
    const std::optional<js::value> answer = json::ParseExact(text);
    const js::object robot = answer && answer->is_object() ? answer->get_object() : js::object();
    const std::string_view presence = TextIn(robot, "presence");
    const std::string_view source = TextIn(robot, "source");
    findings.Check(Thing::kTwinOnline, ruri, presence == "online" && source == "cyberwave",
                   "online, source cyberwave", fmt::format("{}, source {}", presence, source));
    const js::object cyberwave = ObjectIn(robot, "cyberwave");
    CompareParts(ruri, twin.account().live(side), cyberwave, findings);
    CompareSessions(ruri, side, twin.account(), ObjectIn(cyberwave, "sessions"), findings);
  }
}

void CompareTwinPresence(const TwinScript& twin, const StoredTwin& stored, const Span& run,
                         Findings& findings) {
  for (const Side side : {Side::kReal, Side::kSim}) {
    const std::chrono::microseconds silence(twin.account().longest_silence_us(side));
    const std::string wrong =
        WrongPresence(stored.Of(side).presence, run, silence > kTwinSilence ? kAnyTimes : 0);
    findings.Check(Thing::kTwinPresence, twin.ids().RuriOf(side), wrong.empty(),
                   "online at last, never offline", wrong);
  }
}

}  // namespace uplink::synthetic
