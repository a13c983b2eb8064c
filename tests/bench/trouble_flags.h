#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/bench/bench_flags.h"

namespace uplink::bench {

/// What a benchmark of a server in trouble is asked for. A value.
struct TroubleFlags : BenchFlags {
  /// Names of scenarios; all if empty.
  std::vector<std::string> only = {};
  /// The uplinkd that is measured; empty: this build's.
  std::string server_bin = {};
  /// Well-behaved ones.
  int robots = 1;
};

/// What `./dev bench fair` is asked for. A value.
struct FairFlags : TroubleFlags {
  FairFlags() : TroubleFlags{{.seconds = 12}} { robots = 500; }

  /// `sqlite` or `postgres`, which needs the cluster of UPLINK_TEST_POSTGRES.
  std::string store = "sqlite";
  /// What a robot may have of the server's memory by itself.
  int share_mib = 8;
};

/// What `./dev bench hostile` is asked for. A value.
struct HostileFlags : TroubleFlags {
  HostileFlags() : TroubleFlags{{.seconds = 5}} {}
};

template <typename Scenario>
[[nodiscard]] std::vector<std::string> NamesOf(std::span<const Scenario> scenarios) {
  std::vector<std::string> names;
  for (const Scenario& each : scenarios) names.emplace_back(each.name);
  return names;
}
/// Those that `only` names, in its order; all if it is empty.
template <typename Scenario>
[[nodiscard]] std::vector<const Scenario*> ChosenOf(std::span<const Scenario> scenarios,
                                                    const std::vector<std::string>& only) {
  std::vector<const Scenario*> chosen;
  for (const std::string& name : only.empty() ? NamesOf(scenarios) : only) {
    const auto found = std::ranges::find(scenarios, name, &Scenario::name);
    if (found != scenarios.end()) chosen.push_back(&*found);
  }
  return chosen;
}

// Read them into `flags`, whose values are the defaults; `scenarios` are those that there are. The
// exit code where the program is to end: help was asked for, or the use was wrong and the reason
// printed.

[[nodiscard]] std::optional<int> ParseFairFlags(int argc, const char* const* argv,
                                                const std::vector<std::string>& scenarios,
                                                FairFlags& flags);
[[nodiscard]] std::optional<int> ParseHostileFlags(int argc, const char* const* argv,
                                                   const std::vector<std::string>& scenarios,
                                                   HostileFlags& flags);

}  // namespace uplink::bench
