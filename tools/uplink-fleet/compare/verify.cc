#include "tools/uplink-fleet/compare/verify.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "server/view/timestamps.h"

namespace uplink::synthetic {
namespace {

std::string Text(std::uint64_t number) { return fmt::format("{}", number); }

/// How far the server's counters moved during the run.
class Counters {
 public:
  explicit Counters(const Evidence& evidence) : evidence_(evidence) {}

  [[nodiscard]] std::uint64_t Moved(const std::string& name) const {
    return Difference(At(evidence_.after.uplinks(), name), At(evidence_.before.uplinks(), name));
  }
  [[nodiscard]] std::uint64_t Rejected(const std::string& reason) const {
    return Difference(At(evidence_.after.rejects_by_reason(), reason),
                      At(evidence_.before.rejects_by_reason(), reason));
  }
  [[nodiscard]] std::int64_t Now(const std::string& name) const {
    return At(evidence_.after.uplinks(), name);
  }

 private:
  static std::uint64_t Difference(std::int64_t after, std::int64_t before) {
    return after < before ? 0 : static_cast<std::uint64_t>(after - before);
  }
  template <typename Map>
  static std::int64_t At(const Map& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? 0 : found->second;
  }

  const Evidence& evidence_;
};

void CheckCounters(const Evidence& evidence, std::vector<CheckRow>& rows) {
  const FleetTotals& fleet = evidence.fleet;
  const Counters counters(evidence);
  const auto add = [&](std::string what, std::uint64_t mine, std::uint64_t server, bool ok) {
    rows.push_back({std::move(what), Text(mine), Text(server), "", ok, ""});
  };
  const std::uint64_t received = counters.Moved("received");
  const std::uint64_t once = received - std::min(received, counters.Moved("duplicate"));
  add("messages, each once", fleet.numbers, once, once == fleet.numbers);
  if (!evidence.disturbed) {
    add("messages with repeats", fleet.sent, received, received == fleet.sent);
  }
  const std::uint64_t stored = counters.Moved("stored");
  // An upsert that comes after its expiry is superseded: it was durable all the same.
  add("durable, stored", fleet.durable, stored,
      stored <= fleet.durable && stored + fleet.expiring >= fleet.durable);
  const std::uint64_t good = fleet.numbers - std::min(fleet.numbers, fleet.wrongs);
  const std::uint64_t settled = stored + counters.Moved("applied") + counters.Moved("superseded");
  add("good: stored, applied or superseded", good, settled, settled == good);
  const std::uint64_t rejected = counters.Moved("rejected");
  add("wrong on purpose, rejected", fleet.wrongs, rejected, rejected == fleet.wrongs);
  std::set<std::string> reasons;
  for (const auto& [reason, count] : fleet.wrongs_by_reason) reasons.insert(reason);
  for (const auto& [reason, count] : evidence.after.rejects_by_reason()) {
    if (counters.Rejected(reason) > 0) reasons.insert(reason);
  }
  for (const std::string& reason : reasons) {
    const auto mine = fleet.wrongs_by_reason.find(reason);
    const std::uint64_t expected = mine == fleet.wrongs_by_reason.end() ? 0 : mine->second;
    add("rejected: " + reason, expected, counters.Rejected(reason),
        counters.Rejected(reason) == expected);
  }
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

void CheckThings(const Evidence& evidence, std::vector<CheckRow>& rows) {
  for (std::size_t i = 0; i < kTwinThings; ++i) {
    rows.push_back(LineOf(static_cast<Thing>(i), evidence.findings));
  }
}

/// What was due to receivers is in one place of those where it can be.
void CheckForwards(const Evidence& evidence, std::vector<CheckRow>& rows) {
  const FleetTotals& fleet = evidence.fleet;
  rows.push_back({"receivers that showed what they hold", Text(fleet.receivers),
                  Text(evidence.receivers_read), "", evidence.receivers_read == fleet.receivers,
                  ""});
  if (!evidence.forwards_after) {
    rows.push_back({"forwards due = the rest", "", "", "", false, "/metrics does not say"});
    return;
  }
  const Conservation& now = *evidence.forwards_after;
  rows.push_back({"forwards due = the rest", "", fmt::format("{} = {}", now.received, now.sum()),
                  "", now.holds(), ""});
  // What was on its way when a stream broke was written and did not come.
  const bool told = evidence.forwards_before && !Restarted(evidence) && !evidence.disturbed;
  const std::uint64_t before = told ? evidence.forwards_before->Of("written") : 0;
  const std::uint64_t written = now.Of("written") - std::min(now.Of("written"), before);
  rows.push_back({"forwards written", Text(fleet.forwarded_changes), Text(written), "",
                  !told || fleet.forwarded_changes <= written, ""});
  rows.push_back({"forwards coalesced", "", Text(now.Of("coalesced")), "", true, ""});
  rows.push_back({"forwards replaced by a snapshot", "", Text(now.Of("snapshot")), "", true, ""});
  rows.push_back({"forwards dropped with their stream", "", Text(now.Of("dropped")), "", true, ""});
  rows.push_back({"forwards waiting", "", Text(now.in_flight), "", true, ""});
}

}  // namespace

CheckRow LineOf(Thing thing, const Findings& findings) {
  const ThingText text = TextOf(thing);
  const Findings::Tally& tally = findings.Of(thing);
  CheckRow row{std::string(text.name), Text(tally.expected), "", "", tally.differences == 0, ""};
  (text.of_store ? row.store : row.server) = Text(tally.found);
  if (!row.ok) row.note = fmt::format("{} differ, see below", tally.differences);
  return row;
}

void FleetTotals::Add(const RobotOutcome& robot) {
  ++robots;
  numbers += robot.last_seq;
  sent += robot.sent;
  durable += robot.account.good();
  acked += robot.account.good_acked();
  expiring += robot.account.expiring();
  wrongs += robot.account.wrongs().size();
  for (const auto& [tag, wrong] : robot.account.wrongs()) {
    ++wrongs_by_reason[std::string(model::ToText(wrong.reason))];
  }
  settled_robots += robot.all_settled ? 1 : 0;
  ended_ok += robot.ended_ok ? 1 : 0;
  receivers += robot.receives ? 1 : 0;
  forwarded_changes += robot.forwarded_changes;
}

bool AllOk(const std::vector<CheckRow>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const CheckRow& row) { return row.ok; });
}

bool Restarted(const Evidence& evidence) {
  return view::UnixMs(evidence.before.started_at()) != view::UnixMs(evidence.after.started_at());
}

std::vector<CheckRow> VerifyAcks(const Evidence& evidence) {
  const FleetTotals& fleet = evidence.fleet;
  const std::string robots = Text(fleet.robots);
  std::vector<CheckRow> rows;
  rows.push_back({"robots with all settled", Text(fleet.settled_robots), "", "",
                  fleet.settled_robots == fleet.robots, ""});
  rows.push_back({"durable messages acked", Text(fleet.durable), Text(fleet.acked), "",
                  fleet.acked == fleet.durable, ""});
  rows.push_back(
      {"streams ended OK", robots, Text(fleet.ended_ok), "", fleet.ended_ok == fleet.robots, ""});
  rows.push_back({"protocol rules broken", "0", Text(evidence.rules_broken), "",
                  evidence.rules_broken == 0, evidence.first_broken_rule});
  return rows;
}

std::vector<CheckRow> Verify(const Evidence& evidence) {
  std::vector<CheckRow> rows = VerifyAcks(evidence);
  CheckConservation(evidence, rows);
  if (!Restarted(evidence)) CheckCounters(evidence, rows);
  const std::uint64_t robots = evidence.fleet.robots;
  rows.push_back({"robots whose rows were read", Text(robots), "", Text(evidence.robots_read),
                  evidence.robots_read == robots, ""});
  CheckThings(evidence, rows);
  CheckForwards(evidence, rows);
  return rows;
}

}  // namespace uplink::synthetic
