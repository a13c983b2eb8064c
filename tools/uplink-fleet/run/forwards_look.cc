#include "tools/uplink-fleet/run/forwards_look.h"

#include <utility>

#include "tools/uplink-fleet/run/ask_again.h"
#include "tools/uplink-fleet/run/stages.h"

namespace uplink::synthetic {
namespace {

/// For how long what receivers hold may differ. A server that was started anew reads all that is
/// shared before it forwards again, and an item that expires is gone from its lists up to a second
/// before the robots are told.
constexpr milliseconds kAgreeDeadline{15'000};

bool Agree(const ForwardsLook& look, std::size_t receivers) {
  Findings findings;
  CompareForwards(look.shared, look.tables, findings);
  return look.tables.size() == receivers && findings.differences_in_all() == 0;
}

}  // namespace

std::size_t ReceiversOf(const Scenario& scenario) {
  std::size_t receivers = 0;
  for (std::size_t i = 0; i < scenario.robots; ++i) {
    if (!Declines(scenario, i)) ++receivers;
  }
  return receivers;
}

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

}  // namespace uplink::synthetic
