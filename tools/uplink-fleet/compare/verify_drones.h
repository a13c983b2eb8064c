#pragma once

#include <cstdint>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/compare/verify_twins.h"
#include "tools/uplink-fleet/drone/account.h"

namespace uplink::synthetic {

/// What all drones together did. A value.
struct DroneTotals {
  std::uint64_t drones = 0;
  std::uint64_t settled_drones = 0;
  /// Calls that left, those that were answered, and of these those whose answer was taken.
  std::uint64_t sent = 0;
  std::uint64_t answered = 0;
  std::uint64_t taken = 0;
  /// Samples that were wrong on purpose, each counted once.
  std::uint64_t wrongs = 0;

  void Add(const DroneAccount& account);
};

/// Everything that the table of a run with drones is made of. A value.
struct DroneEvidence : SourceCounts {
  DroneTotals totals;
  Findings findings;
  std::uint64_t drones_read = 0;
};

/// The table of such a run. Pure; any thread.
[[nodiscard]] std::vector<CheckRow> VerifyDrones(const DroneEvidence& evidence);

}  // namespace uplink::synthetic
