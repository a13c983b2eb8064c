// Lists of what robots are now.
#include "tools/uplinkctl/verbs/list_tables.h"

namespace uplink::ctl {
namespace {

/// A fleet of this size is shown whole.
constexpr int kRobotsShown = 10'000;
/// Robots that the server names at most.
constexpr int kTopMax = 100;

List Robots() {
  return {
      .noun = "robots",
      .about = "List robots, with presence, battery, faults and backlog",
      .path = "/api/v1/robots",
      .member = "robots",
      .columns = {{"ROBOT", "ruri", Kind::kRobot},
                  {"FLEET", "fleet", Kind::kText, Fit::kShrink},
                  {"PRESENCE", "presence", Kind::kWord},
                  {"FOR", "presenceSince", Kind::kAge},
                  {"HEARD", "lastSignOfLife", Kind::kAge},
                  {"BATTERY", "batteryPercent", Kind::kPercent},
                  {"FAULTS", "activeFaults", Kind::kNumber},
                  {"E-STOP", "estop", Kind::kYes, Fit::kDrop},
                  {"BLOCKED", "blocked", Kind::kYes, Fit::kDrop},
                  {"LABELS", "labels", Kind::kList, Fit::kDrop},
                  {"PARKED UNTIL", "parkedUntil", Kind::kAge, Fit::kDrop},
                  {"FLAPPING", "flapping", Kind::kYes, Fit::kDrop},
                  {"UNSENT", "backlog.uplinks", Kind::kNumber, Fit::kDrop},
                  {"HELD BACK", "heldBack", Kind::kText, Fit::kDrop},
                  {"PLACE", "position", Kind::kPlace, Fit::kDrop},
                  {"AGENT", "agentVersion", Kind::kText, Fit::kDrop},
                  {"NOTE", "note", Kind::kText, Fit::kDrop},
                  {"GATEWAY", "gateway", Kind::kText, Fit::kDrop},
                  {"CERTIFICATE", "certificateNotAfter", Kind::kAge, Fit::kDrop}},
      .filters = {{"--name", "q", "Only robots with this in the last two segments of their RURI"},
                  {"--presence",
                   "presence",
                   "Only robots of this presence",
                   Filter::Kind::kText,
                   {"online", "offline", "unknown"}},
                  {"--offline-before", "offlineBefore",
                   "Only robots that are offline since before then: 1h", Filter::Kind::kBefore},
                  {"--battery-below", "batteryBelow", "Only robots with less charge, in percent"},
                  {"--bbox", "bbox", "Only robots in this area: WEST,SOUTH,EAST,NORTH in degrees"},
                  {"--software", "software", "Only robots with this version of software"},
                  {"--held-back", "heldBack", "Only robots that the server does not read now",
                   Filter::Kind::kSwitch},
                  {"--estop", "estop", "Only robots with an emergency stop", Filter::Kind::kSwitch},
                  {"--faulted", "faulted", "Only robots with active faults", Filter::Kind::kSwitch},
                  {"--label", "label", "Only robots with this label: NAME=VALUE"},
                  {"--blocked", "blocked", "Only robots that are blocked", Filter::Kind::kSwitch},
                  {"--certificate-expires-within", "certificateExpiresBefore",
                   "Only robots whose certificate expires within this time: 14d",
                   Filter::Kind::kWithin},
                  {"--order-by",
                   "orderBy",
                   "Order of the robots; descending with a - before it: --order-by=-backlog",
                   Filter::Kind::kText,
                   {"ruri", "battery", "lastHeard", "backlog", "-ruri", "-battery", "-lastHeard",
                    "-backlog"}}},
      .fixed = {{"parts", "none"}},
      .examples = {"uplinkctl robots list --fleet north --presence offline",
                   "uplinkctl robots list --battery-below 20 --order-by battery",
                   "uplinkctl robots list -o csv > robots.csv"},
      .of_robots = false,
      .in_time = false,
      .limit = kRobotsShown};
}

List Story() {
  return {
      .noun = "robots",
      .verb = "story",
      .about = "Tell what happened to a robot: connections, presence, faults, missions and more",
      .path = "/api/v1/robot/story",
      .member = "entries",
      .columns = {{"TIME", "at", Kind::kTime},
                  {"AGO", "at", Kind::kAge, Fit::kDrop},
                  {"KIND", "kind", Kind::kText},
                  {"WHAT", "title", Kind::kText, Fit::kShrink}},
      .examples = {"uplinkctl robots story r17 --since 22:00Z"},
      .of_fleet = false,
      .of_robots = false,
      .of_one_robot = true,
      .grows_by = "at"};
}

List Top() {
  return {
      .noun = "robots",
      .verb = "top",
      .about = "List the robots that send most now",
      .path = "/api/v1/top",
      .member = "robots",
      .columns = {{"ROBOT", "ruri", Kind::kRobot},
                  {"FLEET", "fleet", Kind::kText, Fit::kShrink},
                  {"PER SECOND", "perSecond", Kind::kRate}},
      .filters =
          {{"--by", "by", "What is counted", Filter::Kind::kText, {"messages", "bytes", "rows"}}},
      .examples = {"uplinkctl robots top --by bytes --follow"},
      .of_robots = false,
      .in_time = false,
      .limit = 10,
      .limit_max = kTopMax};
}

List Fleets() {
  return {.noun = "fleets",
          .about = "List fleets, with presence, faults and versions",
          .path = "/api/v1/fleets",
          .member = "fleets",
          .columns = {{"FLEET", "fleet"},
                      {"ROBOTS", "robots", Kind::kNumber},
                      {"ONLINE", "online", Kind::kNumber},
                      {"OFFLINE", "offline", Kind::kNumber},
                      {"UNKNOWN", "unknown", Kind::kNumber},
                      {"E-STOPS", "estops", Kind::kNumber},
                      {"CRITICAL", "activeFaults.critical", Kind::kNumber},
                      {"MAJOR", "activeFaults.major", Kind::kNumber},
                      {"MINOR", "activeFaults.minor", Kind::kNumber, Fit::kDrop},
                      {"SOFTWARE", "softwareVersions", Kind::kList, Fit::kShrink},
                      {"AGENTS", "agentVersions", Kind::kList, Fit::kDrop}},
          .examples = {"uplinkctl fleets list"},
          .of_robots = false,
          .in_time = false,
          .limit = kRobotsShown};
}

List Shapes() {
  return {.noun = "shapes",
          .about = "List the areas that robots reported and that have not expired",
          .path = "/api/v1/shapes",
          .member = "shapes",
          .columns = {{"ROBOT", "ruri", Kind::kRobot},
                      {"ID", "id", Kind::kText, Fit::kShrink},
                      {"NAME", "name", Kind::kText, Fit::kShrink},
                      {"TYPE", "areaType"},
                      {"SCOPE", "scope"},
                      {"REV", "rev", Kind::kNumber, Fit::kDrop},
                      {"EXPIRES", "expiresAt", Kind::kAge, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge}},
          .filters = {{"--include-expired", "includeExpired", "Also those that have expired",
                       Filter::Kind::kSwitch}},
          .examples = {"uplinkctl shapes list --robot r17"},
          .in_time = false};
}

List Objects() {
  return {.noun = "objects",
          .about = "List the objects that robots track and that have not expired",
          .path = "/api/v1/objects",
          .member = "objects",
          .columns = {{"ROBOT", "ruri", Kind::kRobot},
                      {"ID", "id", Kind::kText, Fit::kShrink},
                      {"NAME", "name", Kind::kText, Fit::kShrink},
                      {"TYPE", "objectType"},
                      {"SCOPE", "scope"},
                      {"EXPIRES", "expiresAt", Kind::kAge, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge}},
          .filters = {{"--include-expired", "includeExpired", "Also those that have expired",
                       Filter::Kind::kSwitch}},
          .examples = {"uplinkctl objects list --fleet north"},
          .in_time = false};
}

}  // namespace

std::vector<List> RobotLists() { return {Fleets(), Robots(), Story(), Top(), Shapes(), Objects()}; }

}  // namespace uplink::ctl
