#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/latest_kind.h"
#include "storage/open_stream.h"
#include "storage/presence.h"
#include "storage/samples.h"

namespace uplink::storage {

/// Requests of one call of Store::ClaimDrones: each returns up to kSampleTypesMax rows.
inline constexpr std::size_t kClaimsMax = 100;

/// A drone calls this process, which wants to commit its samples from now on.
struct ClaimRequest {
  RobotRef robot;
  SystemTime at;
  /// What `robot->fleet` does to a robot that the store has in another fleet. It moves none that
  /// another process goes on holding.
  FleetWord fleet_word = FleetWord::kMoves;
};

/// What a process may do for a drone that calls it.
struct ClaimResult {
  /// The epoch of the claim, drawn anew each time: samples judged under another one, of this
  /// process too, are fenced from now on. 0: the robot is of another fleet (`other_fleet`), nothing
  /// was written, and nothing else is set.
  Epoch claim = 0;
  /// In which fleet the store has the robot, where the request's word does not move it.
  std::optional<std::string> other_fleet;
  /// In which fleet the store had the robot, where this moved it to another.
  std::optional<std::string> moved_from;
  /// The store had a row of the robot before.
  bool was_known = false;
  /// The epoch since which this process holds the robot without interruption, as
  /// OpenResult.held_since. 0: another process goes on holding it. Its live state is that one's;
  /// what is durable commits here all the same.
  Epoch held_since = 0;
  /// Nothing if the store has no change of the robot's presence.
  std::optional<StoredPresence> presence;
  /// The kinds whose latest message of the robot the store has, from any process.
  LatestKindSet latest_kinds = 0;
  /// What is remembered of the drone's samples, by type, ascending; of types without any, nothing.
  std::vector<SampleMemory> samples;
};

}  // namespace uplink::storage
