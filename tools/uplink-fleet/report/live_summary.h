#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// The buckets of one histogram of a metrics page, cumulative, by upper bound; the last is
/// infinite.
using Buckets = std::map<double, double>;
/// Those of `name` in the Prometheus text format; empty if it is not there. Series with labels
/// beside `le` are not looked for.
[[nodiscard]] Buckets HistogramOf(std::string_view page, std::string_view name);
/// The `quantile` of what came between two readings, interpolated within its bucket, as Prometheus
/// does it; none if nothing came. The highest finite bound if it lies above.
[[nodiscard]] std::optional<double> Quantile(const Buckets& before, const Buckets& after,
                                             double quantile);

/// What an operator would watch while a run goes on, line by line: the server's own counters
/// since the line before, and the time from arrival to ack by the server's histogram.
///
/// Thread: confined to one thread.
class LiveSummary final {
 public:
  /// `now` is when status and page were read; both may be missing when the server is away.
  [[nodiscard]] std::string Line(const Shared& shared, SteadyTime now,
                                 const std::optional<v1::ServerStatus>& status,
                                 const std::optional<std::string>& page);

 private:
  struct Reading {
    SteadyTime at{};
    std::int64_t received = 0;
    Buckets ack_seconds;
  };

  std::optional<SteadyTime> began_;
  std::optional<Reading> last_;
};

}  // namespace uplink::synthetic
