#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/reports.h"
#include "server/cyberwave/limits.h"

namespace uplink::cyberwave {

/// The source of every fault that comes from the errors of metrics.
inline constexpr std::string_view kMetricFaultSource = "cyberwave/metrics";

/// The fault id of an error's text: the text itself, or the beginning of a long one with a hash of
/// the whole, at most schema::kIdBytesMax bytes. The same in every process.
[[nodiscard]] std::string FaultIdOf(std::string_view error);

/// The errors that the last metrics of a robot named. A value.
///
/// Limits:  kMetricFaultsMax active faults, and at most kRecordsOfMessageMax changes by one
/// message.
class MetricFaults final {
 public:
  /// Raises faults that are newly named, and clears those that are named no more. The caller must
  /// store all of them: they are not made again.
  [[nodiscard]] std::vector<model::Fault> Take(const std::vector<std::string>& errors,
                                               std::int64_t unix_time_ms);
  /// How many faults Take would return.
  [[nodiscard]] std::size_t CountChanges(const std::vector<std::string>& errors) const;
  /// Replaces the active faults by those of this source in the store, up to the limit. Without it,
  /// faults that an earlier run of the server left there would never be cleared.
  void Restore(const std::vector<std::string>& fault_ids);

  [[nodiscard]] const std::set<std::string, std::less<>>& active() const { return active_; }

 private:
  std::set<std::string, std::less<>> active_;
};

/// Bytes that it holds in memory besides its own size.
[[nodiscard]] std::size_t HeldBytes(const MetricFaults& faults);

}  // namespace uplink::cyberwave
