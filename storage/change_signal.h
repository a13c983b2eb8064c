#pragma once

#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::storage {

/// Shortest time between two signals of a process. Commits in between share one, at its end.
inline constexpr milliseconds kTellEvery{10};

/// How processes that share a store wake each other once there may be changes to read
/// (SharedItems).
///
/// It does not say what changed, and may miss a signal while the store is away, so the one who
/// waits also looks by itself now and then.
///
/// Errors: of Wait: others are neither told nor heard until a later Wait succeeds. What Tell asked
///         for meanwhile is told then.
/// Thread: Tell and End from any; Wait by one thread at a time.
class ChangeSignal {
 public:
  virtual ~ChangeSignal() = default;

  /// Something was committed that the others may want to read. Does not block: Wait sends it.
  virtual void Tell() = 0;
  /// Sends what Tell noted. True as soon as another process has told, false after `most` or End.
  [[nodiscard]] virtual absl::StatusOr<bool> Wait(milliseconds most) = 0;
  /// Ends the Wait under way and each later one at once; a call to the store still takes its time.
  virtual void End() = 0;
};

}  // namespace uplink::storage
