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

/// The id of the fault that an error's text is: the text, or of a long one its beginning and a
/// number that depends on all of it, at most schema::kIdBytesMax bytes. The same in every process.
[[nodiscard]] std::string FaultIdOf(std::string_view error);

/// Which errors the last metrics of a robot named. A value.
///
/// Limits:  kMetricFaultsMax active faults, of which one message makes at most kRecordsOfMessageMax
///          changes.
class MetricFaults final {
 public:
  /// Raises what is named now and was not, and clears what was named and is not. The caller must
  /// have all of it stored: it is not made again.
  [[nodiscard]] std::vector<model::Fault> Take(const std::vector<std::string>& errors,
                                               std::int64_t unix_time_ms);
  /// How many faults Take would give.
  [[nodiscard]] std::size_t CountChanges(const std::vector<std::string>& errors) const;
  /// The ids of the active faults of this source that the store has, instead of those known here:
  /// what an earlier life of the server left, before the first metrics, would stay without it.
  /// Those past the limit are passed over.
  void Restore(const std::vector<std::string>& fault_ids);

  [[nodiscard]] const std::set<std::string, std::less<>>& active() const { return active_; }

 private:
  std::set<std::string, std::less<>> active_;
};

/// What it holds in memory besides itself, in bytes.
[[nodiscard]] std::size_t HeldBytes(const MetricFaults& faults);

}  // namespace uplink::cyberwave
