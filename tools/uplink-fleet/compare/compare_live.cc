#include "tools/uplink-fleet/compare/compare_live.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/core.h>
#include <google/protobuf/descriptor.h>

#include "schema/base/check.h"
#include "server/view/timestamps.h"
#include "storage/live_parts.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

void ComparePart(Thing thing, const RobotOutcome& robot, const Struct& expected,
                 const Struct& found, Findings& findings) {
  if (Canonical(expected) == Canonical(found)) {
    return findings.Check(thing, robot.ruri, true, "", "");
  }
  // The field that differs rather than the whole part, where there is one.
  for (const auto& [name, value] : expected.fields()) {
    const auto other = found.fields().find(name);
    const bool missing = other == found.fields().end();
    if (!missing && Canonical(value) == Canonical(other->second)) continue;
    return findings.Check(
        thing, robot.ruri, false, fmt::format("{}: {}", name, Shown(value)),
        fmt::format("{}: {}", name, missing ? std::string("nothing") : Shown(other->second)));
  }
  findings.Check(thing, robot.ruri, false, Shown(expected), Shown(found));
}

template <typename Body>
void CompareLast(Thing thing, const RobotOutcome& robot, const std::optional<Body>& sent,
                 const Struct& found, Findings& findings) {
  if (sent) ComparePart(thing, robot, PartOf(*sent), found, findings);
}
void CompareLast(Thing thing, const RobotOutcome& robot,
                 const std::optional<model::RcanState>& sent, Struct found, Findings& findings) {
  if (!sent) return;
  // The server's own count: numbers that gave way unsent are missing in it.
  found.mutable_fields()->erase("seq_missing");
  ComparePart(thing, robot, PartOf(*sent, robot.ruri), found, findings);
}
template <typename Body>
void CompareLast(Thing thing, const RobotOutcome& robot, const std::map<std::string, Body>& sent,
                 const Struct& found, Findings& findings) {
  if (!sent.empty()) ComparePart(thing, robot, PartOf(sent), found, findings);
}

/// The field of that JSON name; all live parts are Structs.
const Struct& FieldOf(const v1::Robot& robot, std::string_view name) {
  const auto* field = v1::Robot::descriptor()->FindFieldByCamelcaseName(std::string(name));
  UPLINK_CHECK(field != nullptr && field->message_type() == Struct::descriptor(),
               "every live part has its field in v1::Robot");
  return static_cast<const Struct&>(v1::Robot::GetReflection()->GetMessage(robot, field));
}

bool IsThere(const v1::Robot& robot) { return robot.presence() == "online" && robot.connected(); }

}  // namespace

bool AllThere(const std::map<std::string, v1::Robot>& live, std::size_t robots) {
  const auto there =
      std::ranges::count_if(live, [](const auto& entry) { return IsThere(entry.second); });
  return static_cast<std::size_t>(there) >= robots;
}

void CompareLive(const RobotOutcome& robot, const v1::Robot* live, Findings& findings) {
  if (live == nullptr) {
    return findings.Check(Thing::kOnline, robot.ruri, false, "a robot", "not listed");
  }
  findings.Check(
      Thing::kOnline, robot.ruri, IsThere(*live), "online and connected",
      fmt::format("{}, {}", live->presence(), live->connected() ? "connected" : "not connected"));
  if (live->uplinks_missing() != 0) {
    findings.Find(Thing::kNumbersMissing, static_cast<std::uint64_t>(live->uplinks_missing()));
    findings.Differ(Thing::kNumbersMissing, robot.ruri, "0",
                    fmt::format("{}", live->uplinks_missing()));
  }
  const LastLive& sent = robot.account.live();
#define UPLINK_PART(Part, column, view, Message, keys_max) \
  CompareLast(Thing::k##Part, robot, sent.column, FieldOf(*live, view), findings);
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
  CompareLast(Thing::kAgentInfo, robot, robot.account.agent_info(), live->agent_info(), findings);
  CompareLast(Thing::kSettings, robot, robot.account.settings(), live->settings(), findings);
  CompareLast(Thing::kUiCapabilities, robot, robot.account.ui_capabilities(),
              live->ui_capabilities(), findings);
}

void CompareParked(const RobotOutcome& robot, const v1::Robot* live, Findings& findings) {
  if (robot.parked_until_ms == 0) return;
  const bool parked = live != nullptr && live->has_parked_until();
  const std::int64_t until = parked ? view::UnixMs(live->parked_until()) : 0;
  findings.Check(Thing::kParked, robot.ruri, until == robot.parked_until_ms,
                 fmt::format("parked until {}", robot.parked_until_ms),
                 parked ? fmt::format("until {}", until) : "not parked");
}

void ComparePresence(const RobotOutcome& robot, const StoredRobot& stored, const Span& run,
                     Findings& findings) {
  const std::string wrong = WrongPresence(stored.presence, run, robot.silences);
  findings.Check(Thing::kPresenceHistory, robot.ruri, wrong.empty(),
                 fmt::format("online at last, offline {} times at most", robot.silences), wrong);
}

std::string WrongPresence(const std::vector<v1::PresenceChange>& newest_first, const Span& run,
                          std::uint64_t offline_max) {
  const v1::PresenceChange* latest = nullptr;
  std::uint64_t offline = 0;
  for (const v1::PresenceChange& change : newest_first) {
    if (view::UnixMs(change.at()) > run.to_ms) continue;
    if (latest == nullptr) latest = &change;
    const bool within = view::UnixMs(change.at()) >= run.from_ms;
    if (within && change.presence() == "offline") ++offline;
  }
  const bool online = latest != nullptr && latest->presence() == "online";
  if (online && offline <= offline_max) return {};
  return fmt::format("{} at last, offline {} times",
                     latest == nullptr ? std::string("no change") : latest->presence(), offline);
}

}  // namespace uplink::synthetic
