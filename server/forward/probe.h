#pragma once

#include <chrono>
#include <cstdint>

#include "metrics/cells.h"
#include "schema/base/clock.h"

namespace uplink::forward {

/// Milliseconds of the steady clock, as a cell holds them.
[[nodiscard]] inline std::int64_t SteadyMs(SteadyTime time) {
  return std::chrono::duration_cast<milliseconds>(time.time_since_epoch()).count();
}

/// Counts of reading the shared set from the store. Counts holds what becomes of each change.
/// Thread-safe.
struct ForwardProbe {
  /// Times that all shared items were read from the store.
  metrics::Cell reads_of_all;
  /// Changes of items that were read from the store.
  metrics::Cell changes;
  /// Items of the store that could not be made a command.
  metrics::Cell unreadable;
  /// Of these, those that are there now, up to kUnreadableMax.
  metrics::Cell unreadable_now;
  /// Items whose changes wait because their robot makes the others receive too much.
  metrics::Cell paced_now;
  /// When all changes of the store were last read: milliseconds of the steady clock.
  metrics::Cell followed_at_ms;
  /// 1 while the store cannot be asked for changes.
  metrics::Cell failing;
  /// Notices by other servers that they committed; several at once may count as one.
  metrics::Cell heard;
  /// 1 while other servers can be neither heard nor told.
  metrics::Cell listen_failing;
};

}  // namespace uplink::forward
