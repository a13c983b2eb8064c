#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/report/live_table.h"
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

/// What an operator would watch at one moment of a run. A value.
struct LiveFigures {
  std::int64_t seconds = 0;
  /// As the robots count.
  std::uint64_t acked = 0;
  std::uint64_t rejected = 0;
  std::uint64_t breaks = 0;
  /// False: the server does not answer, and the rest is not known.
  bool answers = false;
  std::int64_t online = 0;
  std::int64_t received = 0;
  std::int64_t stored = 0;
  /// Since the moment before.
  double messages_per_second = 0;
  std::optional<double> ack_p50_seconds;
  std::optional<double> ack_p99_seconds;
};

/// The figures as one line. Pure.
[[nodiscard]] std::string LineOf(const LiveFigures& figures);
/// The figures as a table below `heading`. Pure.
[[nodiscard]] LiveTable TableOf(const LiveFigures& figures, std::string heading);

/// The server's own counters since the moment before, and the time from arrival to ack by the
/// server's histogram.
///
/// Thread: confined to one thread.
class LiveSummary final {
 public:
  /// `now` is when status and page were read; both may be missing when the server is away.
  [[nodiscard]] LiveFigures Take(const Shared& shared, SteadyTime now,
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
