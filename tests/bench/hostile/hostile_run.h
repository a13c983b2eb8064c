#pragma once

#include <functional>
#include <string>

#include "tests/bench/hostile/attack.h"
#include "tests/bench/hostile/hostile_report.h"
#include "tests/bench/world.h"

namespace uplink::bench {

/// What an attack is measured on.
struct HostileRun {
  const World& world;
  std::string server_bin;
  /// Without the attack, and with it unless it needs more.
  milliseconds window{0};
  /// Honest robots.
  int robots = 1;
  /// Somebody wants it to end.
  std::function<bool()> stopped;
  /// A line of progress.
  std::function<void(const std::string&)> say;
};

/// One attack: a fresh server and store, the victim without the attack and with it, new robots
/// during the attack and after it. All that it starts has ended when it returns.
///
/// Errors: a server that misbehaves is in the result, or said.
/// Thread: the main thread's.
[[nodiscard]] HostileResult RunAttack(const HostileRun& run, const Attack& attack);

}  // namespace uplink::bench
