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
  /// Other processes that may be cut off from the store, as of the last look (LeaseJudge::Late).
  metrics::Cell others_late;
  /// 1 while another process may hear robots of which this one cannot learn: it is late, or this
  /// one cannot look.
  metrics::Cell others_unseen;
};

}  // namespace uplink::store
