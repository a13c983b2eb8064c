#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "metrics/cells.h"
#include "server/http/denied.h"
#include "server/http/listeners.h"
#include "server/http/routes.h"

namespace uplink::http {

/// Answers are counted by their class: 2xx, 3xx, 4xx, 5xx.
inline constexpr std::array<std::string_view, 4> kCodeClasses = {"2xx", "3xx", "4xx", "5xx"};

/// A listener's connections. Thread-safe.
struct ConnectionProbe {
  metrics::Cell open;
  metrics::Cell refused;
  metrics::Cell given_up;
};

/// What HTTP counts. Thread-safe.
struct HttpProbe {
  /// By RouteId and code class.
  std::vector<std::array<metrics::Cell, kCodeClasses.size()>> requests =
      std::vector<std::array<metrics::Cell, kCodeClasses.size()>>(RouteIds());
  metrics::LatencyDistribution request_seconds{metrics::kLatencyBoundsSeconds};
  /// By ListenerId.
  std::array<ConnectionProbe, kListenerKeys.size()> connections;
  metrics::Cell reads_waiting;
  /// Scrapes of /metrics, too.
  metrics::Cell reads_refused;
  /// Scrapes of /metrics that wait for their thread.
  metrics::Cell metrics_waiting;
  /// Watches that wait for their thread. Without a metric: each connection has one at most.
  metrics::Cell watches_waiting;
  /// Scrapes of robots that wait for their thread.
  metrics::Cell scrapes_waiting;
  /// By Denied.
  std::array<metrics::Cell, kDeniedTexts.size()> denied;
  /// Tokens of http.tokens_file.
  metrics::Cell tokens;

  void CountRequest(RouteId route, int status) {
    const std::size_t code_class = status < 300 ? 0 : status < 400 ? 1 : status < 500 ? 2 : 3;
    requests[route.index][code_class].Add();
  }
};

}  // namespace uplink::http
