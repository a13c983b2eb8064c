#pragma once

#include "metrics/cells.h"

namespace uplink::store {

/// What the operator sees of the leases. Thread-safe.
struct LeaseProbe {
  /// Renewals of this process's lease.
  metrics::Cell renewed;
  /// 1 while leases cannot be renewed or read.
  metrics::Cell failing;
  /// Other processes whose leases stand, as of the last look.
  metrics::Cell others;
};

}  // namespace uplink::store
