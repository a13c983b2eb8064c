#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/batch.h"
#include "storage/deliveries.h"
#include "storage/outcome.h"

namespace uplink::storage {

/// What a transaction writes and deletes of what is remembered of deliveries. Its holds are those
/// of the batch, which must outlive it.
struct DeliveryChanges {
  struct Row {
    const TopicHold* hold = nullptr;
    Delivery delivery;
  };
  /// Row of a client id, by its number.
  struct Number {
    const TopicHold* hold = nullptr;
    std::uint64_t number = 0;
  };
  std::vector<Row> added;
  /// Those that are DeliveriesKept numbers older than one of the batch: no two batches name the
  /// same.
  std::vector<Number> gone;
};

/// Whether the lease is that of its client id still.
using LeaseStands = std::function<absl::StatusOr<bool>(const TopicHold& hold)>;

/// What becomes of the deliveries of a batch, once for every store: a message is remembered unless
/// one of its records is fenced, and nothing is written under a lease that is over. `outcomes`
/// begins with those of the batch's records.
///
/// Errors: those of `stands`.
[[nodiscard]] absl::StatusOr<DeliveryChanges> DeliveryChangesOf(const Batch& batch,
                                                                std::span<const Outcome> outcomes,
                                                                const LeaseStands& stands);

}  // namespace uplink::storage
