#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/presence.h"
#include "storage/adopt.h"
#include "storage/epoch.h"
#include "storage/presence.h"

namespace uplink::robot {

/// How a robot came to be held by this process.
enum class HoldBegan : std::uint8_t {
  /// It speaks here: a stream of it was opened, or its calls claimed it from nobody.
  kOpened,
  /// Its holder was over, and this process took it.
  kAdopted,
};

/// The store says that this process holds a robot from now on. A value.
struct HoldNews {
  HoldBegan how = HoldBegan::kOpened;
  storage::Epoch since = 0;
  /// As the last holder wrote it.
  std::optional<storage::StoredPresence> presence;
  /// The store knew the robot before.
  bool was_known = false;
  /// Of an adopted robot: how its former holder ended.
  storage::HolderEnd end = storage::HolderEnd::kEnded;
  /// Of an adopted robot: how long it may be unheard before it counts as offline.
  milliseconds grace{0};
};

/// A robot that this process does not hold, as its holder wrote it last. A value.
struct Foreign {
  /// Where robots reach the holder: host and port. Empty while that is not known.
  std::string held_by;
  /// When the holder wrote that; nothing if it did not.
  std::optional<SystemTime> written_at;
};

}  // namespace uplink::robot
