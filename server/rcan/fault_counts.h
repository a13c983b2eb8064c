#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/loop/one_at_a_time.h"
#include "storage/reader.h"

namespace uplink::rcan {

/// How often the active faults are counted for the robots' series, while these are scraped.
inline constexpr std::chrono::seconds kFaultCountsEvery{10};
/// Counts that are older are unknown.
inline constexpr std::chrono::seconds kFaultCountsAgeMax{60};
/// Robots of one question to the store.
inline constexpr std::size_t kFaultCountsRobots = 1000;

/// The active faults of each robot by severity, as the store last said. Thread-safe.
class FaultCounts final {
 public:
  using BySeverity = decltype(storage::ActiveFaults::by_severity);
  using Map = std::unordered_map<std::string, BySeverity>;

  explicit FaultCounts(const Clock& clock) : clock_(clock) {}

  /// Asks the store; waits for it. Errors: of the reader; then the counts before stay until they
  /// are too old.
  [[nodiscard]] absl::Status Refresh(const fleet::Fleet& fleet, storage::Reader& reader);

  /// Asks the store by a job on a thread that may wait for it, unless one is under way. What it
  /// works with outlives the thread.
  void RefreshOn(const loop::Post& post, const fleet::Fleet& fleet, storage::Reader& reader);

  /// The robots that have active faults; null if that is not known now.
  [[nodiscard]] std::shared_ptr<const Map> counts() const;

 private:
  const Clock& clock_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Map> counts_;
  SteadyTime counted_at_;
  loop::OneAtATime refreshes_;
};

}  // namespace uplink::rcan
