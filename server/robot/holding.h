#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/presence.h"
#include "storage/adopt.h"
#include "storage/epoch.h"
#include "storage/presence.h"

namespace uplink::robot {

/// How a robot came to be held by this process.
enum class HoldBegan : std::uint8_t {
  /// It speaks here: its stream was opened, or its calls claimed it while it had no holder.
  kOpened,
  /// Its holder was over, and this process took it.
  kAdopted,
};

/// The store says that this process now holds a robot. A value.
struct HoldNews {
  HoldBegan how = HoldBegan::kOpened;
  storage::Epoch since = 0;
  /// The presence that the last holder wrote.
  std::optional<storage::StoredPresence> presence;
  /// The store knew the robot before.
  bool was_known = false;
  /// For an adopted robot: how its former holder ended.
  storage::HolderEnd end = storage::HolderEnd::kEnded;
  /// For an adopted robot: how long it may be silent before it counts as offline.
  milliseconds grace{0};
};

/// Why the last connection of an adopted robot ended, by the presence that its former holder wrote
/// last: a server that stops in order writes first that presence is unknown.
[[nodiscard]] inline std::optional<model::ConnectionEnd> EndOfHolder(model::Presence written) {
  if (written == model::Presence::kOnline) return model::ConnectionEnd::kServerEnded;
  return std::nullopt;
}

/// A robot that this process does not hold, as its holder last wrote it. A value.
struct Foreign {
  /// Where robots reach the holder: host and port; empty if unknown.
  std::string held_by;
  /// When the holder wrote that; empty if it did not.
  std::optional<SystemTime> written_at;
};

}  // namespace uplink::robot
