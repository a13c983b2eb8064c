#pragma once

#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "tools/link/http_client.h"
#include "tools/terminal/terminal.h"
#include "tools/uplink-fleet/broker/twin_swarm.h"
#include "tools/uplink-fleet/robot/swarm.h"

namespace uplink::synthetic {

/// Exit codes of the program (docs/reference/exit-codes.md).
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongUse = 2;
inline constexpr int kExitMismatch = 3;

/// What one run is told. A value.
struct RunOptions {
  SwarmOptions swarm;
  /// Twins behind a broker, in place of robots on the relay.
  std::optional<TwinSwarmOptions> twins;
  /// Drones that call, in place of robots that stream; `swarm` says where and how many.
  bool drones = false;
  std::uint64_t seed = 1;
  link::HttpServer http{.address = "127.0.0.1:7480"};
  /// Nothing is compared over HTTP: the robots' own acks decide.
  bool acks_only = false;
  milliseconds run_for{30'000};
  /// How long the fleet waits for the server to settle everything, and for each stream to end,
  /// before it calls it a mismatch.
  milliseconds settle_for{60'000};
  bool json = false;
  /// What standard output and standard error are.
  Terminal output;
  Terminal errors;
};

}  // namespace uplink::synthetic
