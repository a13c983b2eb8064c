#include "tools/uplink-fleet/run/gather.h"

#include <utility>

#include <fmt/core.h>

#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_forwards.h"
#include "tools/uplink-fleet/compare/compare_live.h"
#include "tools/uplink-fleet/compare/compare_rows.h"

namespace uplink::synthetic {
namespace {

/// The counters of the queue threads are published a moment after the acks.
constexpr milliseconds kCountersDeadline{3000};

/// Reads the server's counters once nothing is in flight any more.
absl::Status GatherCounters(const RunContext& run, Evidence& evidence) {
  const SteadyTime start = run.clock.Steady();
  while (true) {
    absl::StatusOr<v1::ServerStatus> after = AskAgain(run, [&run] { return run.view.Status(); });
    if (!after.ok()) return after.status();
    evidence.after = std::move(*after);
    const auto in_flight = evidence.after.uplinks().find("inFlight");
    if (in_flight == evidence.after.uplinks().end() || in_flight->second == 0 ||
        run.clock.Steady() - start > kCountersDeadline || run.signals.Wait(kLook)) {
      return absl::OkStatus();
    }
  }
}

/// One reading of the counters of forwarding, and what receivers held.
absl::Status GatherForwards(const RunContext& run, const RunOutcome& outcome, Evidence& evidence) {
  const auto page = AskAgain(run, [&run] { return run.view.Metrics(); });
  if (!page.ok()) return page.status();
  evidence.forwards_after = ForwardsOn(*page);
  const ForwardsLook& look = outcome.look.forwards;
  evidence.receivers_read = look.tables.size();
  CompareForwards(look.shared, look.tables, evidence.findings);
  std::set<std::string> fleet;
  for (const auto& [ruri, robot] : outcome.look.live) fleet.insert(ruri);
  // Of a robot that left the server's memory the items stay, and are the fleet's.
  for (const auto& [key, item] : look.shared) fleet.insert(item.origin);
  // Without a look nothing is known of whose robots they are.
  if (!fleet.empty()) CompareOrigins(outcome.origins, fleet, evidence.findings);
  return absl::OkStatus();
}

absl::Status GatherRobot(const RunContext& run, const RunOutcome& outcome,
                         const RobotOutcome& robot, Evidence& evidence) {
  evidence.fleet.Add(robot);
  const auto live = outcome.look.live.find(robot.ruri);
  CompareViolations(robot, evidence.findings);
  CompareLive(robot, live == outcome.look.live.end() ? nullptr : &live->second, evidence.findings);
  const auto stored = AskAgain(
      run, [&] { return run.view.Stored(robot.ruri, view::UnixMs(evidence.before.now())); });
  if (!stored.ok()) return stored.status();
  ++evidence.robots_read;
  CompareRows(robot, *stored, outcome.id, evidence.findings);
  ComparePresence(robot, *stored, {view::UnixMs(evidence.before.now()), outcome.look.at_ms},
                  evidence.findings);
  return absl::OkStatus();
}

/// The robots once more, now that their streams have ended.
absl::Status GatherParked(const RunContext& run, const RunOutcome& outcome, Evidence& evidence) {
  if (run.options.swarm.parked_for == milliseconds(0)) return absl::OkStatus();
  const auto live = AskAgain(run, [&run] { return run.view.Robots(run.options.swarm.fleet); });
  if (!live.ok()) return live.status();
  for (const RobotOutcome& robot : outcome.robots) {
    const auto found = live->find(robot.ruri);
    CompareParked(robot, found == live->end() ? nullptr : &found->second, evidence.findings);
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Gather(const RunContext& run, const RunOutcome& outcome, Evidence& evidence) {
  if (absl::Status status = GatherCounters(run, evidence); !status.ok()) return status;
  if (absl::Status status = GatherForwards(run, outcome, evidence); !status.ok()) return status;
  for (const RobotOutcome& robot : outcome.robots) {
    // Thousands of robots take minutes to compare.
    if (run.signals.Came()) {
      return absl::CancelledError(fmt::format("told to stop after {} of {} robots were compared",
                                              evidence.robots_read, outcome.robots.size()));
    }
    run.progress.Tell(
        fmt::format("compared {} of {} robots", evidence.robots_read, outcome.robots.size()));
    absl::Status status = GatherRobot(run, outcome, robot, evidence);
    if (!status.ok()) return status;
  }
  return GatherParked(run, outcome, evidence);
}

}  // namespace uplink::synthetic
