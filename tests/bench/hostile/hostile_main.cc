// What hostile clients do to a server: attacks one by one, each on a server and
// a store of its own, beside an honest robot. The server has one core, everybody else the other.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/hostile/hostile_flags.h"
#include "tests/bench/hostile/hostile_run.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::bench {
namespace {

void Say(const std::string& text) {
  fmt::print(stderr, "{}{}", text, text.ends_with('\n') ? "" : "\n");
}

int Run(int argc, char** argv) {
  HostileFlags flags;
  if (const auto code = ParseHostileFlags(argc, argv, flags)) return *code;
  const SystemClock clock;
  synthetic::Signals signals(clock);
  bool stopped = false;
  const bool apart = PinTo(kLoadCore);
  const World world;
  const HostileRun run{.world = world,
                       .server_bin = flags.server_bin.empty() ? UPLINKD_PROGRAM : flags.server_bin,
                       .window = std::chrono::seconds(flags.seconds),
                       .robots = flags.robots,
                       .stopped = [&] { return stopped = stopped || signals.Came(); },
                       .say = Say};
  std::vector<HostileResult> results;
  for (int round = 0; round < flags.rounds; ++round) {
    for (const Attack* attack : flags.attacks) {
      if (run.stopped()) break;
      results.push_back(RunAttack(run, *attack));
      fmt::print(stderr, "{}", HostileTable({results.back()}));
    }
  }
  fmt::print(
      "hostile: {} with 20 durable messages per second each, the server on {}; {} rounds, {} s"
      " without each attack and at least as long with it\n{}",
      flags.robots == 1 ? "one robot" : fmt::format("{} robots", flags.robots),
      apart ? "a core of its own" : "the only core", flags.rounds, flags.seconds,
      HostileTable(results));
  const bool kept = KeepJson(flags.json, HostileRows(results), flags.commit);
  const bool measured = std::ranges::any_of(
      results, [](const HostileResult& result) { return result.failure.empty(); });
  return measured && kept && !stopped ? 0 : 1;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
