#pragma once

#include <cstdint>
#include <optional>

#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/presence.h"

namespace uplink::storage {

/// What is known of a holder that is over.
enum class HolderEnd : std::uint8_t {
  /// It gave its robots up, or is not there any more: no robot streams to it.
  kEnded,
  /// It is silent. It may live and have its robots' streams, and be cut off from the store alone.
  kSilent,
};

/// A robot whose holder is over: to be held by this process from now on.
struct AdoptRequest {
  RobotRef robot;
  /// Who held it when that was read.
  ProcessId holder{};
  /// The counter of the holder's lease then; 0 if it had none.
  std::uint64_t lease_counter = 0;
  HolderEnd end = HolderEnd::kEnded;
};

struct AdoptResult {
  /// The epoch since which this process holds the robot. Nothing if it does not: another opened a
  /// stream of it or adopted it sooner, its holder renewed its lease, or the store lost it.
  std::optional<Epoch> held_since;
  /// As OpenResult's, of a robot that was adopted.
  std::optional<StoredPresence> presence;
  /// kSilent if any of those who held it since its last OpenStream was: the robot may stream to
  /// that one still.
  HolderEnd end = HolderEnd::kEnded;
};

}  // namespace uplink::storage
