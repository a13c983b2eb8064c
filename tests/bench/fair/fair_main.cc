// What one robot costs the others: well-behaved robots beside one that misbehaves in every way that
// it may, before and while it does. The server has one core, all robots the other.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/fair/fair_run.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::bench {
namespace {

void Say(const std::string& text) {
  fmt::print(stderr, "{}{}", text, text.ends_with('\n') ? "" : "\n");
}

int Run(int argc, char** argv) {
  FairFlags flags;
  if (const auto code = ParseFairFlags(argc, argv, flags)) return *code;
  const SystemClock clock;
  synthetic::Signals signals(clock);
  bool stopped = false;
  const bool apart = PinTo(kLoadCore);
  World world;
  world.MakeRobots(static_cast<std::size_t>(flags.robots));
  const FairRun run{.world = world,
                    .flags = flags,
                    .server_bin = flags.server_bin.empty() ? UPLINKD_PROGRAM : flags.server_bin,
                    .bad_robot_bin = BAD_ROBOT_PROGRAM,
                    .stopped = [&] { return stopped = stopped || signals.Came(); },
                    .say = Say};
  std::vector<FairResult> results;
  for (int round = 0; round < flags.rounds; ++round) {
    for (const Misdeed misdeed : flags.misdeeds) {
      if (run.stopped()) break;
      results.push_back(RunScenario(run, misdeed));
      fmt::print(stderr, "{}", FairTable({results.back()}, flags.share_mib));
    }
  }
  fmt::print(
      "fair: {} robots with a live message per second and an event every two, on {}; the server on"
      " {}; {} rounds, two windows of {} s each, without the bad robot and with it\n{}",
      flags.robots, flags.store, apart ? "a core of its own" : "the only core", flags.rounds,
      flags.seconds, FairTable(results, flags.share_mib));
  const bool kept = KeepJson(flags.json, FairRows(results, flags.share_mib), flags.commit);
  const bool measured =
      std::ranges::any_of(results, [](const FairResult& result) { return result.failure.empty(); });
  return measured && kept && !stopped ? 0 : 1;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
