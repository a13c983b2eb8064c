#pragma once

#include <cstdint>
#include <optional>

#include "schema/model/rejection.h"

namespace uplink::storage {

enum class OutcomeKind : std::uint8_t {
  /// Written now (for a QuarantineItem: to quarantine; for a LimitedRange: to the kept Rejects).
  kStored,
  /// At or below the cursor, or a second copy within the batch, and never rejected.
  kDuplicate,
  /// Not kept, now or (for a number at or below the cursor) earlier: its row of quarantine, or of
  /// the kept Rejects, says why.
  kRefused,
  /// This process does not hold the robot under the record's `held_since`: another one holds it, or
  /// its row is gone. Or the record came under a lease on topics that is over. It was not examined.
  kFenced,
};

/// The store's answer for one record, or for one change of presence.
struct Outcome {
  OutcomeKind kind = OutcomeKind::kStored;
  /// Of kRefused alone.
  std::optional<model::Rejection> rejection;
};

}  // namespace uplink::storage
