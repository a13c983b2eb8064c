#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "metrics/cells.h"

namespace uplink::http {

/// What a path is, for counting: one for each route, and one for everything else. Closed.
enum class RouteId : std::uint8_t {
  kLivez,
  kReadyz,
  kMetrics,
  kMetricsRobots,
  kStatus,
  kRobots,
  kRobot,
  kEvents,
  kMessages,
  kPresence,
  kQuarantine,
  kGaps,
  kFaults,
  kMissions,
  kShapes,
  kObjects,
  kOther,
};
inline constexpr std::array<std::string_view, 17> kRouteNames = {
    "livez",  "readyz",   "metrics",  "metrics_robots", "status",     "robots",
    "robot",  "events",   "messages", "presence",       "quarantine", "gaps",
    "faults", "missions", "shapes",   "objects",        "other"};
/// Answers are counted by their class: 2xx, 4xx, 5xx.
inline constexpr std::array<std::string_view, 3> kCodeClasses = {"2xx", "4xx", "5xx"};

/// What the HTTP server counts. Thread-safe.
struct HttpProbe {
  std::array<std::array<metrics::Cell, kCodeClasses.size()>, kRouteNames.size()> requests;
  metrics::LatencyDistribution request_seconds{metrics::kLatencyBoundsSeconds};
  metrics::Cell connections;
  metrics::Cell connections_refused;
  metrics::Cell reads_waiting;
  metrics::Cell reads_refused;
  /// Scrapes of robots that wait for their thread.
  metrics::Cell scrapes_waiting;

  void CountRequest(RouteId route, int status) {
    const std::size_t code_class = status < 400 ? 0 : status < 500 ? 1 : 2;
    requests[static_cast<std::size_t>(route)][code_class].Add();
  }
};

}  // namespace uplink::http
