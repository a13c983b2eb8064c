#pragma once

#include "metrics/cells.h"

namespace uplink::transport {

/// What the transport counts beside its sessions. Thread-safe; one for all queues.
struct RelayProbe {
  /// Calls that ended before they became a session.
  metrics::Cell refused_full_total;
  /// One certificate has too many streams.
  metrics::Cell refused_robot_total;
  metrics::Cell refused_draining_total;
  metrics::Cell refused_identity_total;
  /// Calls that were cancelled because the peer did not take their end.
  metrics::Cell finish_timeouts_total;
  /// Wakes that a queue's thread answered; one may stand for many.
  metrics::Cell wakes_total;
};

}  // namespace uplink::transport
