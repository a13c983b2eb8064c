// uplink_simulate: replays seeds of the deterministic simulation.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "server/config/flags.h"
#include "tests/simulation/backends.h"
#include "tests/simulation/drones_sqlite.h"
#include "tests/simulation/drones_world.h"
#include "tests/simulation/sqlite_backend.h"

namespace uplink::simulation {
namespace {

struct Arguments {
  std::uint64_t seed = 1;
  std::uint64_t seeds = 1;
  std::uint32_t steps = 400;
  std::string store = "fake";
  bool drones = false;
  bool digest = false;
  bool trace = false;
};

std::unique_ptr<Backend> NewBackend(const std::string& store) {
  if (store == "sqlite") return std::make_unique<SqliteBackend>();
  return std::make_unique<FakeBackend>();
}

/// Prints lines of a trace where the arguments ask for that.
Trace TraceFor(const Arguments& arguments) {
  return Trace(arguments.trace ? [](std::string_view line) { fmt::print("{}\n", line); }
                               : Trace::Show());
}

/// Says what a seed broke, and how to see it again.
void PrintViolation(const Arguments& arguments, std::uint64_t seed, const std::string& violation) {
  fmt::print("{}\nrepeat with: ./dev simulate{} --seed {} --steps {} --store {}\n", violation,
             arguments.drones ? " --drones" : "", seed, arguments.steps, arguments.store);
}

std::unique_ptr<DronesBackend> NewDronesBackend(const std::string& store) {
  if (store == "sqlite") return std::make_unique<SqliteDronesBackend>();
  return std::make_unique<FakeDronesBackend>();
}

DronesResult RunDronesSeed(const Arguments& arguments, std::uint64_t seed) {
  const std::unique_ptr<DronesBackend> backend = NewDronesBackend(arguments.store);
  Trace trace = TraceFor(arguments);
  const bool traced = arguments.digest || arguments.trace;
  DronesResult result =
      DronesWorld(*backend,
                  {.seed = seed, .steps = arguments.steps, .trace = traced ? &trace : nullptr})
          .Run();
  if (arguments.digest) fmt::print("{} {:016x}\n", seed, trace.digest());
  return result;
}

int RunDrones(const Arguments& arguments) {
  DronesResult sum;
  for (std::uint64_t i = 0; i < arguments.seeds; ++i) {
    const DronesResult result = RunDronesSeed(arguments, arguments.seed + i);
    if (!result.violation.empty()) {
      PrintViolation(arguments, arguments.seed + i, result.violation);
      return 1;
    }
    for (const auto& [end, count] : result.ends) sum.ends[end] += count;
    sum.kills += result.kills;
    sum.claims += result.claims;
    sum.fenced += result.fenced;
    sum.duplicates += result.duplicates;
  }
  std::string ends;
  for (const auto& [end, count] : sum.ends) ends += fmt::format(" {} {}", end, count);
  fmt::print(
      "{} seeds of drones from {}:{}; {} claims, {} samples fenced, {} known to the store, {} "
      "kills: every promise kept\n",
      arguments.seeds, arguments.seed, ends, sum.claims, sum.fenced, sum.duplicates, sum.kills);
  return 0;
}

/// Runs one seed and prints of its trace what the arguments ask for.
RunResult RunSeed(const Arguments& arguments, const Payloads& payloads, std::uint64_t seed) {
  const std::unique_ptr<Backend> backend = NewBackend(arguments.store);
  Trace trace = TraceFor(arguments);
  const bool traced = arguments.digest || arguments.trace;
  World world(payloads, *backend,
              {.seed = seed, .steps = arguments.steps, .trace = traced ? &trace : nullptr});
  RunResult result = world.Run();
  if (arguments.digest) fmt::print("{} {:016x}\n", seed, trace.digest());
  return result;
}

int RunSeeds(const Arguments& arguments) {
  const Payloads payloads;
  std::uint64_t received = 0;
  forward::Counts forwards;
  std::uint64_t kills = 0;
  std::uint64_t breaks = 0;
  std::uint64_t failovers = 0;
  std::uint64_t steps = 0;
  for (std::uint64_t i = 0; i < arguments.seeds; ++i) {
    const RunResult result = RunSeed(arguments, payloads, arguments.seed + i);
    if (!result.violation.empty()) {
      PrintViolation(arguments, arguments.seed + i, result.violation);
      return 1;
    }
    received += result.uplinks.received;
    forwards += result.forwards;
    kills += result.kills;
    breaks += result.breaks;
    failovers += result.failovers;
    steps += result.steps;
  }
  fmt::print(
      "{} seeds from {}, {} steps, {} messages, {} forwards and {} snapshots, {} kills, {} breaks, "
      "{} "
      "failovers: every promise kept\n",
      arguments.seeds, arguments.seed, steps, received, forwards.written, forwards.snapshots, kills,
      breaks, failovers);
  return 0;
}

}  // namespace
}  // namespace uplink::simulation

int main(int argc, char** argv) {
  uplink::simulation::Arguments arguments;
  uplink::config::Flags flags(
      "The deterministic simulation of agents or drones, streams or calls, journal and store");
  flags.Add({"--seed", "First seed"}, arguments.seed);
  flags.Add({"--seeds", "How many seeds, each one more than the last"}, arguments.seeds);
  flags.Add({"--steps", "Steps with faults, before everything must settle"}, arguments.steps);
  flags.AddChoice({"--store", "The store under test"}, arguments.store, {"fake", "sqlite"});
  flags.AddSwitch({"--drones", "Drones that call one or two servers, in place of agents"},
                  arguments.drones);
  flags.AddSwitch({"--digest",
                   "Print each seed with the digest of its trace: equal digests before and after a "
                   "change mean the same frames, calls of the store and rows, in the same order"},
                  arguments.digest);
  flags.AddSwitch({"--trace", "Print the trace itself: what a digest stands for"}, arguments.trace);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  return arguments.drones ? uplink::simulation::RunDrones(arguments)
                          : uplink::simulation::RunSeeds(arguments);
}
