#include "tools/uplink-fleet/compare/compare_twin_live.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <boost/json.hpp>
#include <fmt/core.h>

#include "schema/json/exact.h"
#include "tools/uplink-fleet/compare/live_parts.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// Bytes of a value that are shown of a difference.
constexpr std::size_t kShownBytes = 120;

std::string_view TextIn(const js::object& object, const char* name) {
  const js::value* value = object.if_contains(name);
  if (value == nullptr || !value->is_string()) return {};
  return {value->get_string().data(), value->get_string().size()};
}

std::string Cut(const std::string& text) { return text.substr(0, kShownBytes); }

void CompareParts(const std::string& ruri, const SentParts& sent,
                  std::map<std::string, std::string> found, Findings& findings) {
  for (const auto& [path, part] : sent) {
    if (part.last().empty()) continue;
    findings.Expect(Thing::kTwinLive);
    const auto shown = found.find(path);
    if (shown == found.end()) {
      findings.Differ(Thing::kTwinLive, ruri, Cut(path + ": " + part.last()), path + ": nothing");
      continue;
    }
    if (shown->second == part.last()) {
      findings.Find(Thing::kTwinLive);
    } else {
      const char* why = part.WasSent(shown->second) ? "sent earlier" : "never sent, or long ago";
      findings.Differ(Thing::kTwinLive, ruri, Cut(path + ": " + part.last()),
                      fmt::format("{} ({})", Cut(shown->second), why));
    }
    found.erase(shown);
  }
  for (const auto& [path, text] : found) {
    findings.Differ(Thing::kTwinLive, ruri, path + ": nothing", Cut(text));
  }
}

std::string SessionText(const js::object* sessions, const std::string& id) {
  const js::value* session = sessions == nullptr ? nullptr : sessions->if_contains(id);
  if (session == nullptr || !session->is_object()) return "no such session";
  const auto flag = [session](const char* name) {
    const js::value* value = session->get_object().if_contains(name);
    return value == nullptr || !value->is_bool() ? "?" : value->get_bool() ? "yes" : "no";
  };
  return fmt::format("connected {}, telemetry {}", flag("connected"), flag("telemetry"));
}

std::string SessionText(const SentSession& session) {
  const auto flag = [](std::optional<bool> value) { return !value ? "?" : *value ? "yes" : "no"; };
  return fmt::format("connected {}, telemetry {}", flag(session.connected),
                     flag(session.telemetry));
}

void CompareSessions(const std::string& ruri, Side side, const TwinAccount& account,
                     const js::object* found, Findings& findings) {
  for (const auto& [id, session] : account.sessions()) {
    if (session.side != side) continue;
    findings.Expect(Thing::kTwinSessions);
    const std::string expected = SessionText(session);
    const std::string shown = SessionText(found, id);
    if (shown == expected) {
      findings.Find(Thing::kTwinSessions);
    } else {
      findings.Differ(Thing::kTwinSessions, ruri, fmt::format("{}: {}", id, expected), shown);
    }
  }
}

void CompareRobot(const std::string& ruri, const js::object& robot, Findings& findings) {
  const std::string_view presence = TextIn(robot, "presence");
  const std::string_view source = TextIn(robot, "source");
  findings.Expect(Thing::kTwinOnline);
  if (presence == "PRESENCE_ONLINE" && source == "cyberwave") {
    findings.Find(Thing::kTwinOnline);
  } else {
    findings.Differ(Thing::kTwinOnline, ruri, "online, source cyberwave",
                    fmt::format("{}, source {}", presence, source));
  }
}

}  // namespace

void CompareTwinLive(const TwinScript& twin, const TwinLook& look, Findings& findings) {
  for (const Side side : {Side::kReal, Side::kSim}) {
    const std::string& ruri = side == Side::kReal ? twin.ids().ruri : twin.ids().sim_ruri;
    const std::string& text = look.at(static_cast<std::size_t>(side));
    findings.Expect(Thing::kTwinSecrets);
    if (text.find(kSecret) == std::string::npos) {
      findings.Find(Thing::kTwinSecrets);
    } else {
      findings.Differ(Thing::kTwinSecrets, ruri, "no secret of signalling or commands", "one");
    }
    const std::optional<js::value> answer = json::ParseExact(text);
    const js::object none;
    const bool known = answer && answer->is_object();
    const js::object& robot = known ? answer->get_object() : none;
    CompareRobot(ruri, robot, findings);
    const js::value* shown = robot.if_contains("cyberwave");
    const js::object* cyberwave = shown == nullptr ? nullptr : shown->if_object();
    const js::value* sessions = cyberwave == nullptr ? nullptr : cyberwave->if_contains("sessions");
    CompareParts(ruri, twin.account().live(side),
                 LivePartsOf(cyberwave == nullptr ? none : *cyberwave), findings);
    CompareSessions(ruri, side, twin.account(),
                    sessions == nullptr ? nullptr : sessions->if_object(), findings);
  }
}

}  // namespace uplink::synthetic
