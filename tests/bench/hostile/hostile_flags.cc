#include "tests/bench/hostile/hostile_flags.h"

#include <cstdio>

#include <fmt/core.h>

#include "tests/support/flags.h"

namespace uplink::bench {
namespace {

constexpr int kWrongUse = 2;

std::string Names() {
  std::string names;
  for (const Attack& attack : Attacks()) {
    if (!names.empty()) names += ", ";
    names += attack.name;
  }
  return names;
}

}  // namespace

std::optional<int> ParseHostileFlags(int argc, const char* const* argv, HostileFlags& flags) {
  std::vector<std::string> only;
  testing::Flags parser("A server under attack, beside an honest robot", "uplink_bench_hostile");
  parser.Add({"--json", "Where the figures go as JSON"}, flags.json);
  parser.Add({"--commit", "What is measured"}, flags.commit);
  parser.Add({"--only", "Attacks; all if none is named: " + Names()}, only);
  parser.Add({"--server-bin", "The uplinkd that is attacked; this build's if none is named"},
             flags.server_bin);
  parser.Add({"--seconds", "Without the attack and with it; some attacks need more"}, flags.seconds,
             {1, 600});
  parser.Add({"--rounds"}, flags.rounds, {1, 100});
  parser.Add({"--robots", "Honest robots"}, flags.robots, {1, 100});
  if (const auto code = parser.Parse(argc, argv)) return code;
  for (const std::string& name : only) {
    const Attack* const attack = AttackOf(name);
    if (attack == nullptr) {
      fmt::print(stderr, "--only: unknown attack: {} ({})\n", name, Names());
      return kWrongUse;
    }
    flags.attacks.push_back(attack);
  }
  if (flags.attacks.empty()) {
    for (const Attack& attack : Attacks()) flags.attacks.push_back(&attack);
  }
  return std::nullopt;
}

}  // namespace uplink::bench
