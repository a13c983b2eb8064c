#pragma once

#include <chrono>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::storage {

/// An older snapshot is reported. Our longest read takes 5 s, so such a snapshot is another
/// program's; a report or a small dump is done by then. At 1,000 messages per second a snapshot of
/// this age keeps 600,000 dead versions of cursors, some 60 MB.
inline constexpr std::chrono::minutes kOldSnapshot{10};

/// Facts about the database or file behind a store.
struct StoreFacts {
  /// A loss of power may lose what was acked, and the operator accepted it.
  bool unsafe = false;
  /// The store's clock less ours, as of its last connection.
  milliseconds clock_offset{0};
  /// Commits since the start that the database answered with a warning: whether they are durable
  /// was unknown, and they failed.
  std::uint64_t commits_in_doubt = 0;
  /// How long something else has kept dead row versions from being removed, or the WAL of an SQLite
  /// store from being moved into its file.
  milliseconds oldest_snapshot{0};

  [[nodiscard]] bool old_snapshot() const { return oldest_snapshot > kOldSnapshot; }
};

}  // namespace uplink::storage
