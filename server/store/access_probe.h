#pragma once

#include "metrics/cells.h"

namespace uplink::store {

/// What is known of who may not come in. Any thread.
struct AccessProbe {
  /// Revocations that count: those of the store, and those of authorities' files.
  metrics::Cell of_store;
  metrics::Cell of_files;
};

}  // namespace uplink::store
