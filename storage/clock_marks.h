#pragma once

#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::storage {

/// What a store says of civil time.
struct ClockReading {
  /// A time at which a server's clock was vouched for; nothing if there was none yet.
  std::optional<SystemTime> mark;
  /// The store's own clock, now; nothing if it has none but the machine's.
  std::optional<SystemTime> database;
};

/// The mark of civil time in a store, one for all servers that share it, over a connection of its
/// own, so that a commit that takes long does not delay judging the clock.
///
/// Errors: as in Store: a status means that nothing of the call is known.
/// Thread: confined to one thread at a time.
class ClockMarks {
 public:
  virtual ~ClockMarks() = default;

  [[nodiscard]] virtual absl::StatusOr<ClockReading> Read() = 0;
  /// Sets the mark, whatever it was: it may go back.
  [[nodiscard]] virtual absl::Status Set(SystemTime mark) = 0;
  /// Sets the mark if there is none and the store has no row that it could lose.
  [[nodiscard]] virtual absl::Status SetIfEmpty(SystemTime mark) = 0;
};

}  // namespace uplink::storage
