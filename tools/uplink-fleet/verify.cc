#include "tools/uplink-fleet/verify.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/verify_rows.h"

namespace uplink::synthetic {
namespace {

/// The fleet's own sums.
struct FleetTotals {
  std::uint64_t numbers = 0;
  std::uint64_t sent = 0;
  std::uint64_t faults = 0;
  std::uint64_t wrongs = 0;
  std::uint64_t live = 0;
  std::uint64_t unsettled_robots = 0;
  std::uint64_t ended_ok = 0;
  std::uint64_t faults_rejected = 0;
  std::string first_fault_rejection;
};

FleetTotals Totals(const std::vector<RobotOutcome>& robots) {
  FleetTotals totals;
  for (const RobotOutcome& robot : robots) {
    totals.numbers += robot.last_seq;
    totals.sent += robot.sent;
    totals.faults += robot.ledger.faults.size();
    totals.wrongs += robot.ledger.wrongs.size();
    totals.unsettled_robots += robot.all_settled ? 0 : 1;
    totals.ended_ok += robot.ended_ok ? 1 : 0;
    totals.faults_rejected += robot.ledger.faults_rejected;
    if (totals.first_fault_rejection.empty()) {
      totals.first_fault_rejection = robot.ledger.first_fault_rejection;
    }
  }
  // Every number that is neither a fault nor wrong is a live message.
  totals.live = totals.numbers - std::min(totals.numbers, totals.faults + totals.wrongs);
  return totals;
}

std::string Text(std::uint64_t number) { return fmt::format("{}", number); }

/// How far the server's counters moved during the run.
class Counters {
 public:
  explicit Counters(const Evidence& evidence) : evidence_(evidence) {}

  [[nodiscard]] std::uint64_t Moved(const std::string& name) const {
    const std::int64_t moved =
        At(evidence_.after.uplinks(), name) - At(evidence_.before.uplinks(), name);
    return moved < 0 ? 0 : static_cast<std::uint64_t>(moved);
  }
  [[nodiscard]] std::int64_t Now(const std::string& name) const {
    return At(evidence_.after.uplinks(), name);
  }

 private:
  template <typename Map>
  static std::int64_t At(const Map& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? 0 : found->second;
  }

  const Evidence& evidence_;
};

void CheckCounters(const Evidence& evidence, const FleetTotals& fleet,
                   std::vector<CheckRow>& rows) {
  const Counters counters(evidence);
  const std::uint64_t received = counters.Moved("received");
  const std::uint64_t duplicate = counters.Moved("duplicate");
  const std::uint64_t live = counters.Moved("applied") + counters.Moved("superseded");
  rows.push_back({"messages, each once", Text(fleet.numbers), Text(received - duplicate), "",
                  received - duplicate == fleet.numbers, ""});
  if (!evidence.disturbed) {
    rows.push_back({"messages with repeats", Text(fleet.sent), Text(received), "",
                    received == fleet.sent, ""});
  }
  rows.push_back({"durable, stored", Text(fleet.faults), Text(counters.Moved("stored")), "",
                  counters.Moved("stored") == fleet.faults, ""});
  rows.push_back(
      {"live, applied or superseded", Text(fleet.live), Text(live), "", live == fleet.live, ""});
  rows.push_back({"wrong on purpose, rejected", Text(fleet.wrongs),
                  Text(counters.Moved("rejected")), "", counters.Moved("rejected") == fleet.wrongs,
                  ""});
}

void CheckConservation(const Evidence& evidence, std::vector<CheckRow>& rows) {
  const Counters counters(evidence);
  const std::int64_t sum = counters.Now("stored") + counters.Now("applied") +
                           counters.Now("superseded") + counters.Now("duplicate") +
                           counters.Now("rejected") + counters.Now("inFlight");
  const std::int64_t received = counters.Now("received");
  rows.push_back({"conservation: received = the rest", "", fmt::format("{} = {}", received, sum),
                  "", received == sum, ""});
  rows.push_back({"in flight at the end", "0", fmt::format("{}", counters.Now("inFlight")), "",
                  counters.Now("inFlight") == 0, ""});
}

void CheckLive(const Evidence& evidence, std::vector<CheckRow>& rows) {
  std::uint64_t online = 0;
  std::uint64_t equal = 0;
  std::uint64_t missing = 0;
  std::string difference;
  std::string absent;
  for (const RobotOutcome& robot : evidence.robots) {
    const auto found = evidence.live.find(robot.ruri);
    if (found == evidence.live.end()) {
      if (absent.empty()) absent = robot.ruri + ": the server does not list it";
      continue;
    }
    const v1::Robot& live = found->second;
    if (live.presence() == v1::PRESENCE_ONLINE && live.connected()) {
      ++online;
    } else if (absent.empty()) {
      absent = fmt::format("{}: {}, {}", robot.ruri, v1::Presence_Name(live.presence()),
                           live.connected() ? "connected" : "not connected");
    }
    missing += static_cast<std::uint64_t>(live.uplinks_missing());
    const std::string differs = CompareLive(robot, live);
    if (differs.empty()) ++equal;
    if (difference.empty()) difference = differs;
  }
  const std::uint64_t robots = evidence.robots.size();
  rows.push_back({"robots online", Text(robots), Text(online), "", online == robots, absent});
  rows.push_back(
      {"last motion and status equal", Text(robots), Text(equal), "", equal == robots, difference});
  rows.push_back({"numbers missing", "0", Text(missing), "", missing == 0, ""});
}

void CheckRows(const Evidence& evidence, const FleetTotals& fleet, std::vector<CheckRow>& rows) {
  RowCounts counts;
  std::uint64_t unread = 0;
  for (const RobotOutcome& robot : evidence.robots) {
    const auto stored = evidence.stored.find(robot.ruri);
    if (stored == evidence.stored.end()) {
      ++unread;
      continue;
    }
    counts.Add(CompareRows(robot, stored->second, evidence.run));
  }
  const std::string why = counts.first_difference;
  const auto add = [&](std::string what, std::string mine, std::string store, bool ok) {
    rows.push_back({std::move(what), std::move(mine), "", std::move(store), ok, ok ? "" : why});
  };
  rows.push_back({"robots whose rows were read", Text(evidence.robots.size()), "",
                  Text(evidence.robots.size() - unread), unread == 0, ""});
  rows.push_back({"faults acked", Text(counts.faults_acked), "", Text(counts.faults_stored),
                  counts.faults_missing == 0 && counts.faults_stored >= counts.faults_acked,
                  counts.faults_missing == 0 ? "" : why});
  add("faults equal in content", Text(counts.faults_stored), Text(counts.faults_equal),
      counts.faults_equal == counts.faults_stored);
  add("faults stored twice", "0", Text(counts.faults_doubled), counts.faults_doubled == 0);
  add("faults never reported", "0", Text(counts.faults_foreign), counts.faults_foreign == 0);
  add("active faults", Text(counts.active_expected), Text(counts.active_stored),
      counts.active_wrong == 0);
  add("wrong on purpose, in quarantine", Text(counts.wrongs_acked), Text(counts.wrongs_stored),
      counts.quarantine_bad == 0);
  add("gaps", "0", Text(counts.gaps), counts.gaps == 0);
  rows.push_back({"wrong on purpose, told before the ack", Text(counts.wrongs_acked),
                  Text(counts.wrongs_told), "", counts.wrongs_told == counts.wrongs_acked,
                  counts.wrongs_told == counts.wrongs_acked ? "" : why});
  rows.push_back({"good faults rejected", "0", Text(fleet.faults_rejected), "",
                  fleet.faults_rejected == 0, fleet.first_fault_rejection});
}

}  // namespace

bool Restarted(const Evidence& evidence) {
  return evidence.before.started_at_ms() != evidence.after.started_at_ms();
}

std::vector<CheckRow> Verify(const Evidence& evidence) {
  const FleetTotals fleet = Totals(evidence.robots);
  const std::uint64_t robots = evidence.robots.size();
  std::vector<CheckRow> rows;
  rows.push_back({"robots with all settled", Text(robots - fleet.unsettled_robots), "", "",
                  fleet.unsettled_robots == 0, ""});
  rows.push_back(
      {"streams ended OK", Text(robots), Text(fleet.ended_ok), "", fleet.ended_ok == robots, ""});
  rows.push_back({"protocol rules broken", "0", Text(evidence.rules_broken), "",
                  evidence.rules_broken == 0, evidence.first_broken_rule});
  CheckLive(evidence, rows);
  CheckConservation(evidence, rows);
  if (!Restarted(evidence)) CheckCounters(evidence, fleet, rows);
  CheckRows(evidence, fleet, rows);
  return rows;
}

}  // namespace uplink::synthetic
