#pragma once

#include "metrics/cells.h"

namespace uplink::view {

/// What watches count. Thread-safe.
struct WatchProbe {
  /// Open now.
  metrics::Cell open;
  /// Robots that were shown, and RURIs of those that were removed.
  metrics::Cell shown;
  metrics::Cell removed;
  /// Watches that ended because their readers took nothing.
  metrics::Cell slow;
  /// Watches that did not begin, at a bound.
  metrics::Cell refused;
};

}  // namespace uplink::view
