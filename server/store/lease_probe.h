#pragma once

#include "metrics/cells.h"

namespace uplink::store {

/// Metrics of the leases. Thread-safe.
struct LeaseProbe {
  /// Renewals of this process's lease.
  metrics::Cell renewed;
  /// 1 while leases cannot be renewed or read.
  metrics::Cell failing;
  /// Other processes with valid leases, as of the last look.
  metrics::Cell others;
  /// Other processes that may be cut off from the store, as of the last look (LeaseJudge::Late).
  metrics::Cell others_late;
  /// 1 while another process may hear robots without our knowledge: it is late, or this process
  /// cannot look.
  metrics::Cell others_unseen;
};

}  // namespace uplink::store
