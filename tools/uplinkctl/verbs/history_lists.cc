// Lists of what robots reported, and of what the server noted about them.
#include <iterator>
#include <string>
#include <vector>

#include "schema/model/connection.h"
#include "tools/uplinkctl/verbs/list_tables.h"

namespace uplink::ctl {
namespace {

List Faults() {
  return {.noun = "faults",
          .about = "List faults that are active now, or by --history every report",
          .path = "/api/v1/faults",
          .member = "faults",
          .columns = {{"TIME", "receivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"SEVERITY", "severity", Kind::kWord},
                      {"ACTIVE", "active", Kind::kYes},
                      {"FAULT", "faultId", Kind::kText, Fit::kShrink},
                      {"SOURCE", "source", Kind::kText, Fit::kDrop},
                      {"DESCRIPTION", "description", Kind::kText, Fit::kShrink},
                      {"SEEN BY", "acknowledgement.by", Kind::kText, Fit::kDrop},
                      {"DO", "suggestedAction", Kind::kText, Fit::kDrop}},
          .filters = {{"--history", "active", "Every report, also of faults that have ended",
                       Filter::Kind::kUnless},
                      {"--severity",
                       "severity",
                       "Only faults of this severity",
                       Filter::Kind::kText,
                       {"info", "minor", "major", "critical"}},
                      {"--fault-id", "faultId", "Only this fault"},
                      {"--source", "source", "Only faults of this part of the robot"}},
          .examples = {"uplinkctl faults list --severity critical",
                       "uplinkctl faults list --history --robot r17 --fault-id brake.worn"},
          .grows_by = "receivedAt"};
}

List Missions() {
  return {.noun = "missions",
          .about = "List mission runs",
          .path = "/api/v1/missions",
          .member = "missions",
          .columns = {{"BEGAN", "firstReceivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "lastReceivedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"RUN", "runId", Kind::kText},
                      {"MISSION", "missionId", Kind::kText, Fit::kShrink},
                      {"NAME", "name", Kind::kText, Fit::kShrink},
                      {"STATUS", "status", Kind::kWord},
                      {"REPORTS", "updates", Kind::kNumber, Fit::kDrop},
                      {"CLOSED", "closedWhy", Kind::kText, Fit::kDrop}},
          .filters = {{"--status",
                       "status",
                       "Only runs of this status",
                       Filter::Kind::kText,
                       {"unknown", "ready", "starting", "running", "paused", "blocked", "aborted",
                        "complete", "error"}},
                      {"--open", "open", "Only runs that have not ended", Filter::Kind::kSwitch},
                      {"--mission", "missionId", "Only runs of this mission"},
                      {"--run", "runId", "Only this run"}},
          .examples = {"uplinkctl missions list --since 24h --status error",
                       "uplinkctl missions list --open --fleet north"}};
}

List Events() {
  return {.noun = "events",
          .about = "List events that robots reported",
          .path = "/api/v1/events",
          .member = "events",
          .columns = {{"TIME", "receivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"KIND", "kind", Kind::kText},
                      {"DETAIL", "detail", Kind::kText, Fit::kShrink}},
          .filters = {{"--kind", "kind", "Only events of this kind: estopEngaged"}},
          .examples = {"uplinkctl events list --fleet north --since 22:00Z --oldest",
                       "uplinkctl events list --robot r17 --follow"},
          .grows_by = "receivedAt"};
}

List Messages() {
  return {.noun = "messages",
          .about = "List the texts that robots wrote for people",
          .path = "/api/v1/messages",
          .member = "messages",
          .columns = {{"TIME", "receivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"LEVEL", "level", Kind::kWord},
                      {"MESSAGE", "message", Kind::kText, Fit::kShrink}},
          .filters = {{"--level",
                       "level",
                       "Only messages of this level",
                       Filter::Kind::kText,
                       {"info", "warn", "error"}}},
          .examples = {"uplinkctl messages list --level error --since 2h"},
          .grows_by = "receivedAt"};
}

List Presence() {
  return {.noun = "presence",
          .about = "List when robots came and went, and why",
          .path = "/api/v1/presence",
          .member = "presenceChanges",
          .columns = {{"TIME", "at", Kind::kTime},
                      {"AGO", "at", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"PRESENCE", "presence", Kind::kWord},
                      {"WHY", "why", Kind::kWord}},
          .examples = {"uplinkctl presence list --since 2026-05-01T03:00:00Z --oldest",
                       "uplinkctl presence list --fleet north --follow"},
          .grows_by = "at"};
}

List Gaps() {
  return {.noun = "gaps",
          .about = "List the ranges of numbers that robots skipped",
          .path = "/api/v1/gaps",
          .member = "gaps",
          .columns = {{"TIME", "seenAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "seenAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"FIRST", "firstSeq", Kind::kNumber},
                      {"LAST", "lastSeq", Kind::kNumber},
                      {"SESSION", "sessionId", Kind::kText, Fit::kDrop}},
          .examples = {"uplinkctl gaps list --robot r17"},
          .grows_by = "seenAt"};
}

/// Why a connection may have ended.
std::vector<std::string> EndWords() {
  std::vector<std::string> words;
  words.reserve(model::kAllConnectionEnds.size());
  for (const model::ConnectionEnd why : model::kAllConnectionEnds)
    words.emplace_back(model::ToText(why));
  return words;
}

List Connections() {
  return {.noun = "connections",
          .about = "List connections of robots: from where, how long, and why each ended",
          .path = "/api/v1/connections",
          .member = "connections",
          .columns = {{"BEGAN", "beganAt", Kind::kTime},
                      {"AGO", "beganAt", Kind::kAge, Fit::kDrop},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"FROM", "address", Kind::kText},
                      {"LASTED", "beganAt,end.at", Kind::kLength},
                      {"ENDED", "end.why", Kind::kWord},
                      {"MESSAGES", "messages", Kind::kNumber},
                      {"BYTES", "bytes", Kind::kBytes, Fit::kDrop},
                      {"DETAIL", "end.detail", Kind::kText, Fit::kShrink},
                      {"CODE", "end.code", Kind::kText, Fit::kDrop},
                      {"HELD BACK", "heldBack.why", Kind::kText, Fit::kDrop},
                      {"AGENT", "agentVersion", Kind::kText, Fit::kDrop},
                      {"SERIAL", "certificate.serial", Kind::kText, Fit::kDrop},
                      {"CERTIFICATE", "certificate.notAfter", Kind::kAge, Fit::kDrop},
                      {"GATEWAY", "gateway", Kind::kText, Fit::kDrop},
                      {"SERVER", "server", Kind::kText, Fit::kDrop}},
          .filters = {{"--open", "open", "Only connections that last", Filter::Kind::kSwitch},
                      {"--why", "why", "Only those that ended so", Filter::Kind::kText, EndWords()},
                      {"--source",
                       "source",
                       "Only those of robots that are heard this way",
                       Filter::Kind::kText,
                       {"uplink", "cyberwave", "uncrew"}}},
          .examples = {"uplinkctl connections list --robot r17",
                       "uplinkctl connections list --fleet north --since 2h --why silent"}};
}

List Quarantine() {
  return {.noun = "quarantine",
          .about = "List messages that the server rejected, and why",
          .path = "/api/v1/quarantine",
          .member = "quarantined",
          .columns = {{"TIME", "receivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"SEQ", "seq", Kind::kText},
                      {"REASON", "reason", Kind::kText},
                      {"FIELD", "field", Kind::kText, Fit::kShrink},
                      {"DETAIL", "detail", Kind::kText, Fit::kShrink},
                      {"BYTES", "payloadBytes", Kind::kBytes, Fit::kDrop},
                      {"TOPIC", "topic", Kind::kText, Fit::kDrop}},
          .filters = {{"--reason", "reason", "Only this reason: out_of_range"},
                      {"--source",
                       "source",
                       "Only messages that came this way",
                       Filter::Kind::kText,
                       {"uplink", "cyberwave", "uncrew"}}},
          .examples = {"uplinkctl quarantine list --since 24h --reason out_of_range"},
          .grows_by = "receivedAt"};
}

List ScopeUpdates() {
  return {.noun = "scope-updates",
          .about = "List changes of Cyberwave environments and workflow runs",
          .path = "/api/v1/scope-updates",
          .member = "scopeUpdates",
          .columns = {{"TIME", "receivedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "receivedAt", Kind::kAge},
                      {"SCOPE", "scope"},
                      {"ID", "id"},
                      {"TYPE", "type"},
                      {"DETAIL", "detail", Kind::kText, Fit::kShrink}},
          .filters = {{"--scope",
                       "scope",
                       "Only this scope",
                       Filter::Kind::kText,
                       {"environment", "workflow_run"}},
                      {"--id", "id", "Only this environment or run: its UUID"}},
          .examples = {"uplinkctl scope-updates list --scope workflow_run --since 1h"},
          .of_robots = false,
          .grows_by = "receivedAt"};
}

List OperatorRequests() {
  return {.noun = "operator-requests",
          .about = "List what drones asked operators to confirm",
          .path = "/api/v1/operator-requests",
          .member = "operatorRequests",
          .columns = {{"TIME", "openedAt", Kind::kTime, Fit::kDrop},
                      {"AGO", "openedAt", Kind::kAge},
                      {"ROBOT", "ruri", Kind::kRobot},
                      {"KIND", "kind"},
                      {"TEXT", "text", Kind::kText, Fit::kShrink},
                      {"LASTED", "openedAt,closedAt", Kind::kLength},
                      {"CLOSED", "closedAt", Kind::kTime, Fit::kDrop}},
          .filters = {{"--open", "open", "Only requests that wait", Filter::Kind::kSwitch}},
          .examples = {"uplinkctl operator-requests list --open"}};
}

}  // namespace

std::vector<List> HistoryLists() {
  return {Faults(), Missions(),    Events(),     Messages(),     Presence(),
          Gaps(),   Connections(), Quarantine(), ScopeUpdates(), OperatorRequests()};
}

std::vector<List> Lists() {
  std::vector<List> lists = RobotLists();
  for (std::vector<List> more : {HistoryLists(), AdminLists()}) {
    lists.insert(lists.end(), std::make_move_iterator(more.begin()),
                 std::make_move_iterator(more.end()));
  }
  return lists;
}

}  // namespace uplink::ctl
