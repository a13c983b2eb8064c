#pragma once

#include <vector>

#include "storage/batch.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"
#include "storage/remember.h"

namespace uplink::storage::postgres {

/// Adds the statements that write what is remembered of deliveries, if there is any. Each row is
/// looked for by its whole key, and none is of two transactions, so that commits under one lease do
/// not wait for each other.
void AddDeliveryCalls(const DeliveryChanges& changes, std::vector<StoreCall>& calls);

/// Adds the statement with which a batch begins that came under leases: it fails if one of them is
/// over.
void AddHoldCall(const Batch& batch, const ProcessId& process, std::vector<StoreCall>& calls);

}  // namespace uplink::storage::postgres
