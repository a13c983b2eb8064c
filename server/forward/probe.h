#pragma once

#include "metrics/cells.h"

namespace uplink::forward {

/// What the reading of the shared set counts; what becomes of changes counts itself (counts.h).
/// Thread-safe.
struct ForwardProbe {
  /// Times that all shared items were read from the store.
  metrics::Cell reads_of_all;
  /// Changes of items that were read from the store.
  metrics::Cell changes;
  /// Items that the store holds and that could not be made a command.
  metrics::Cell unreadable;
  /// 1 while the store cannot be asked for changes.
  metrics::Cell failing;
  /// Times that other servers told of their commits, as far as they were heard apart.
  metrics::Cell heard;
  /// 1 while they cannot be heard or told.
  metrics::Cell deaf;
};

}  // namespace uplink::forward
