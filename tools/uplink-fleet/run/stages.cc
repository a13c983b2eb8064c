#include "tools/uplink-fleet/run/stages.h"

#include <atomic>
#include <cstddef>
#include <utility>

#include <absl/status/statusor.h>

#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_live.h"

namespace uplink::synthetic {
namespace {

/// Without any Welcome for that long at the start, nothing can be run.
constexpr milliseconds kFirstWelcomeDeadline{15'000};

/// For a robot whose connection ends for its age at the very moment: it comes back after a pause.
constexpr milliseconds kBackDeadline{10'000};
/// For how long what receivers hold may differ. A server that was started anew reads all that is
/// shared before it forwards again, and an item that expires is gone from its lists up to a second
/// before the robots are told.
constexpr milliseconds kAgreeDeadline{15'000};

/// Waits until as many robots as there are have been counted, `times` over.
bool WaitForAll(const RunContext& run, const std::atomic<std::size_t>& counted,
                std::size_t times = 1) {
  return WaitFor(run, counted, run.options.swarm.scenario.robots * times);
}

}  // namespace

bool WaitFor(const RunContext& run, const std::atomic<std::size_t>& counted, std::size_t robots) {
  const SteadyTime start = run.clock.Steady();
  while (counted.load() < robots) {
    if (run.clock.Steady() - start > run.options.settle_for) return false;
    run.progress.ShowStatus();
    // A signal while settling gives up the rest.
    if (run.signals.Wait(kLook)) return false;
  }
  return true;
}

namespace {

/// The robots as the server shows them once all of the run are there, or at the deadline.
absl::StatusOr<std::map<std::string, v1::Robot>> LookAtRobots(const RunContext& run) {
  const RunOptions& options = run.options;
  const SteadyTime start = run.clock.Steady();
  while (true) {
    auto live = AskAgain(run, [&] { return run.view.Robots(options.swarm.fleet); });
    if (!live.ok() || AllThere(*live, options.swarm.scenario.robots) ||
        run.clock.Steady() - start > kBackDeadline || run.signals.Wait(kLook)) {
      return live;
    }
  }
}

/// The robots that take what others share.
std::size_t ReceiversOf(const Scenario& scenario) {
  std::size_t receivers = 0;
  for (std::size_t i = 0; i < scenario.robots; ++i) {
    if (!Declines(scenario, i)) ++receivers;
  }
  return receivers;
}

bool Agree(const ForwardsLook& look, std::size_t receivers) {
  Findings findings;
  CompareForwards(look.shared, look.tables, findings);
  return look.tables.size() == receivers && findings.differences_in_all() == 0;
}

/// Looks, in Stage::kLast, until both sides agree, for some seconds: items expire meanwhile, and
/// receivers hear that a moment later. The last look if they never do.
ForwardsLook LookAtForwards(const RunContext& run) {
  const std::size_t receivers = ReceiversOf(run.options.swarm.scenario);
  ForwardsLook look;
  if (receivers == 0) return look;
  const SteadyTime start = run.clock.Steady();
  while (true) {
    auto shared = AskAgain(run, [&run] { return run.view.Shared(run.options.swarm.fleet); });
    run.shared.forwards.Ask();
    const bool shown = WaitFor(run, run.shared.forwards.shown(), receivers);
    if (shared.ok()) look = {std::move(*shared), run.shared.forwards.Take()};
    if (!shown || Agree(look, receivers) || run.clock.Steady() - start > kAgreeDeadline ||
        run.signals.Wait(kLook)) {
      return look;
    }
  }
}

}  // namespace

Readiness AwaitRobots(const RunContext& run) {
  const std::size_t threads = run.options.swarm.threads;
  bool told = false;
  while (run.shared.threads_ready.load() < threads && !told) told = run.signals.Wait(kLook);
  if (run.shared.threads_ready.load() < threads) run.shared.abandon.store(true);
  return told ? Readiness::kToldToStop : Readiness::kReady;
}

bool Send(const RunContext& run) {
  const SteadyTime start = run.clock.Steady();
  while (run.clock.Steady() - start < run.options.run_for) {
    run.progress.ShowStatus();
    if (run.signals.Wait(kLook)) break;
    if (run.shared.welcomes.load() == 0 && run.clock.Steady() - start > kFirstWelcomeDeadline) {
      return false;
    }
  }
  return run.shared.welcomes.load() > 0;
}

LastLook Settle(const RunContext& run) {
  LastLook look;
  run.shared.stage.store(Stage::kSettle);
  if (!WaitForAll(run, run.shared.settled_robots)) return look;
  run.shared.stage.store(Stage::kLast);
  const SteadyTime start = run.clock.Steady();
  for (std::size_t round = 1; run.clock.Steady() - start < run.options.settle_for; ++round) {
    const auto began = AskAgain(run, [&run] { return run.view.Status(); });
    run.shared.last_round.store(round);
    if (!WaitForAll(run, run.shared.last_robots, round)) return look;
    auto live = LookAtRobots(run);
    const auto ended = AskAgain(run, [&run] { return run.view.Status(); });
    if (!began.ok() || !live.ok() || !ended.ok()) continue;
    look = {.live = std::move(*live), .at_ms = view::UnixMs(ended->now()), .forwards = {}};
    // A server that was started anew in between has forgotten what it acked as judged.
    if (view::UnixMs(began->started_at()) == view::UnixMs(ended->started_at())) break;
  }
  look.forwards = LookAtForwards(run);
  return look;
}

void SettleAcks(const RunContext& run) {
  run.shared.stage.store(Stage::kSettle);
  // Robots that do not settle in time show in their outcome.
  static_cast<void>(WaitForAll(run, run.shared.settled_robots));
}

void Close(const RunContext& run, bool reached) {
  run.shared.stage.store(Stage::kClose);
  if (!reached || !WaitForAll(run, run.shared.closed_robots)) run.shared.abandon.store(true);
}

}  // namespace uplink::synthetic
