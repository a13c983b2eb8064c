#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tests/bench/figures.h"

namespace uplink::bench {

/// The goals that stand beside the figures.
inline constexpr double kVictimRatioMax = 3;
/// What a server's memory may grow by, whatever is done to it.
inline constexpr double kGrowthMaxMiB = 64;

/// One attack in one round. A value.
struct HostileResult {
  std::string attack;
  /// Why there are no figures; empty if there are.
  std::string failure = {};
  /// The server ended by itself.
  bool server_ended = false;
  /// After the attack, without a restart; no value: not within kGetsInWithin.
  std::optional<milliseconds> new_robot_after = std::nullopt;
  /// While the attack went on, the same.
  std::optional<milliseconds> new_robot_during = std::nullopt;
  /// The victim's: from the write of a message to its Ack.
  std::vector<double> ack_ms_without = {};
  std::vector<double> ack_ms_with = {};
  std::uint64_t acked = 0;
  /// Acked, and not in the store.
  std::uint64_t lost = 0;
  /// Streams of the victim's that ended; messages without an Ack five seconds after the attack.
  std::uint64_t cut = 0;
  std::uint64_t unacked = 0;
  /// What the process had before the attack, and how much more at its most.
  double memory_mib = 0;
  double growth_mib = 0;
  /// A line of a warning, from the attack on, has the attacker's address or robot.
  bool in_log = false;
  /// What counted the attack most: `resets 50`; empty: nothing did.
  std::string metric = {};
};

/// A table with the goals and which of them are missed. Of several rounds the waits are put
/// together, and the worst of the rest is shown.
[[nodiscard]] std::string HostileTable(const std::vector<HostileResult>& results);
/// The same for `--json`: rows named ATTACK_FIGURE. What has no value is -1.
[[nodiscard]] std::vector<Row> HostileRows(const std::vector<HostileResult>& results);

}  // namespace uplink::bench
