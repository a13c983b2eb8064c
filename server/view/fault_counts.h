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

namespace uplink::view {

/// How often the active faults are counted, while the robots' series are scraped.
inline constexpr std::chrono::seconds kFaultCountsEvery{10};
/// An answer that filters by faults asks the store again if the counts are as old as that.
inline constexpr std::chrono::seconds kFaultCountsFresh{2};
/// Older counts are not shown.
inline constexpr std::chrono::seconds kFaultCountsAgeMax{60};
/// Robots of one question to the store.
inline constexpr std::size_t kFaultCountsRobots = 1000;

/// The active faults of each robot by severity, as last read from the store. Thread-safe.
class FaultCounts final {
 public:
  using BySeverity = decltype(storage::ActiveFaults::by_severity);
  using Map = std::unordered_map<std::string, BySeverity>;

  explicit FaultCounts(const Clock& clock) : clock_(clock) {}

  /// Reads the store, and waits for it. Errors: of the reader; the previous counts then stay until
  /// they are too old.
  [[nodiscard]] absl::Status Refresh(const fleet::Fleet& fleet, storage::Reader& reader);

  /// Reads the store by a job on a thread that may wait for it, unless one is under way. The
  /// references outlive the thread.
  void RefreshOn(const loop::Post& post, const fleet::Fleet& fleet, storage::Reader& reader);

  /// Counted within kFaultCountsFresh.
  [[nodiscard]] bool fresh() const;
  /// The robots that have active faults; null if that is unknown now.
  [[nodiscard]] std::shared_ptr<const Map> counts() const;

 private:
  const Clock& clock_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Map> counts_;
  SteadyTime counted_at_;
  loop::OneAtATime refreshes_;
};

}  // namespace uplink::view
