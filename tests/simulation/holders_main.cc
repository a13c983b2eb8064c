// uplink_simulate_holders: replays seeds of several server processes on one store.
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/config/flags.h"
#include "tests/simulation/holders_world.h"

namespace uplink::simulation {
namespace {

using Trouble = HoldersOptions::Trouble;

constexpr std::array<std::pair<std::string_view, Trouble>, 6> kTroubles{
    {{"none", Trouble::kNone},
     {"updates", Trouble::kUpdates},
     {"all", Trouble::kAll},
     {"rows", Trouble::kRows},
     {"suspends", Trouble::kSuspends},
     {"failovers", Trouble::kFailovers}}};

struct Arguments {
  std::uint64_t seed = 1;
  std::uint64_t seeds = 1;
  std::string trouble = "all";
  int fault = 0;
  bool trace = false;
};

Trouble TroubleOf(const std::string& name) {
  for (const auto& [known, trouble] : kTroubles) {
    if (name == known) return trouble;
  }
  return Trouble::kNone;
}

/// The number of seeds that broke a promise; each is a line.
std::uint64_t RunSeeds(const Arguments& arguments) {
  std::uint64_t broken = 0;
  for (std::uint64_t seed = arguments.seed; seed < arguments.seed + arguments.seeds; ++seed) {
    const HoldersResult result = HoldersWorld({.seed = seed,
                                               .trouble = TroubleOf(arguments.trouble),
                                               .fault = static_cast<HoldersFault>(arguments.fault)})
                                     .Run();
    if (arguments.trace) fmt::print("{}\n", fmt::join(result.lines, "\n"));
    if (result.violation.empty()) continue;
    fmt::print("{} {}: {}\n", arguments.trouble, seed, result.violation);
    ++broken;
  }
  fmt::print("{} seeds of {} from {}: {} broke a promise\n", arguments.seeds, arguments.trouble,
             arguments.seed, broken);
  return broken;
}

}  // namespace
}  // namespace uplink::simulation

int main(int argc, char** argv) {
  uplink::simulation::Arguments arguments;
  std::vector<std::string> names;
  names.reserve(uplink::simulation::kTroubles.size());
  for (const auto& [name, trouble] : uplink::simulation::kTroubles) names.emplace_back(name);
  uplink::config::Flags flags("Presence with several server processes on one store",
                              "uplink_simulate_holders");
  flags.Add({"--seed", "First seed"}, arguments.seed);
  flags.Add({"--seeds", "How many seeds, each one more than the last"}, arguments.seeds);
  flags.AddChoice({"--trouble", "What happens"}, arguments.trouble, names);
  flags.Add({"--fault", "The planted fault by its place in HoldersFault; 0: none"}, arguments.fault,
            {0, static_cast<int>(uplink::simulation::HoldersFault::kLast)});
  flags.AddSwitch({"--trace", "Print what happened"}, arguments.trace);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  return uplink::simulation::RunSeeds(arguments) == 0 ? 0 : 1;
}
