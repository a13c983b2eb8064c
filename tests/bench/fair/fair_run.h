#pragma once

#include <functional>
#include <string>

#include "tests/bench/fair/fair_flags.h"
#include "tests/bench/fair/fair_report.h"
#include "tests/bench/world.h"

namespace uplink::bench {

/// What a scenario is measured on.
struct FairRun {
  const World& world;
  const FairFlags& flags;
  std::string server_bin;
  std::string bad_robot_bin;
  /// Somebody wants it to end.
  std::function<bool()> stopped;
  /// A line of progress.
  std::function<void(const std::string&)> say;
};

/// One scenario: a fresh server and store, the well-behaved robots, a window without the bad robot
/// and one with it. All that it starts has ended when it returns.
///
/// Errors: a server or robot that misbehaves is in the result, or said.
/// Thread: the main thread's.
[[nodiscard]] FairResult RunScenario(const FairRun& run, Misdeed misdeed);

}  // namespace uplink::bench
