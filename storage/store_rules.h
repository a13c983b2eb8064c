#pragma once

#include <chrono>

#include "schema/base/clock.h"
#include "storage/clock_trust.h"

namespace uplink::storage {

/// Configured rules that every store applies. Immutable.
struct StoreRules {
  /// Life of an object that names no expiry (forward.object_ttl); zero: for ever. Counted from its
  /// arrival.
  milliseconds object_ttl{std::chrono::hours(24)};
  /// How long rows of history are kept, and closed mission runs; zero: for ever. Whole days count:
  /// what arrived on a day (UTC) goes when the day ended longer ago than this.
  milliseconds retain_history{std::chrono::days(90)};
  /// The same of quarantine, and of gaps.
  milliseconds retain_quarantine{std::chrono::days(14)};
  /// The same of connections that have ended.
  milliseconds retain_connections{std::chrono::days(90)};
  /// The same of the audit.
  milliseconds retain_audit{std::chrono::days(400)};
  /// Vouches for the civil clock; outlives the store. Until it does, nothing is deleted for its age
  /// or its expiry, and nothing has expired for an upsert.
  const ClockTrust* clock = nullptr;
};

}  // namespace uplink::storage
