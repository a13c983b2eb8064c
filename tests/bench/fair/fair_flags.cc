#include "tests/bench/fair/fair_flags.h"

#include <cstdio>

#include <fmt/core.h>

#include "tests/support/flags.h"

namespace uplink::bench {
namespace {

constexpr int kWrongUse = 2;

std::string Names() {
  std::string names;
  for (const Misdeed misdeed : kMisdeeds) names += (names.empty() ? "" : ", ") + NameOf(misdeed);
  return names;
}

}  // namespace

std::optional<int> ParseFairFlags(int argc, const char* const* argv, FairFlags& flags) {
  std::vector<std::string> only;
  testing::Flags parser("Well-behaved robots beside one that is not", "uplink_bench_fair");
  parser.Add({"--json", "Where the figures go as JSON"}, flags.json);
  parser.Add({"--commit", "What is measured"}, flags.commit);
  parser.Add({"--only", "Scenarios; all if none is named: " + Names()}, only);
  parser.AddChoice({"--store"}, flags.store, {"sqlite", "postgres"});
  parser.Add({"--server-bin", "The uplinkd that is measured; this build's if none is named"},
             flags.server_bin);
  parser.Add({"--robots", "Well-behaved ones"}, flags.robots, {1, 5000});
  parser.Add({"--seconds", "Of each of the two windows of a scenario"}, flags.seconds, {1, 600});
  parser.Add({"--rounds"}, flags.rounds, {1, 100});
  parser.Add({"--share-mib", "Memory that the bad robot may add beside a tenth"}, flags.share_mib,
             {0, 1'000'000});
  if (const auto code = parser.Parse(argc, argv)) return code;
  for (const std::string& name : only) {
    const auto misdeed = MisdeedOf(name);
    if (!misdeed) {
      fmt::print(stderr, "--only: unknown scenario: {} ({})\n", name, Names());
      return kWrongUse;
    }
    flags.misdeeds.push_back(*misdeed);
  }
  if (flags.misdeeds.empty()) flags.misdeeds.assign(kMisdeeds.begin(), kMisdeeds.end());
  return std::nullopt;
}

}  // namespace uplink::bench
