#pragma once

#include <vector>

#include "storage/deliveries.h"
#include "storage/postgres/link/connection.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// Adds the statements that write what is remembered of deliveries, if there are any. Each row is
/// looked for by its whole key.
void AddDeliveryCalls(const std::vector<const Deliveries*>& all, std::vector<StoreCall>& calls);

/// Adds the statement with which a batch begins that came under leases: it fails if one of them is
/// over.
void AddHoldCall(const Batch& batch, std::vector<StoreCall>& calls);

}  // namespace uplink::storage::postgres
