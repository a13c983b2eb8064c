#pragma once

#include "metrics/cells.h"

namespace uplink::rcan {

/// What the robots' scrapes count. Thread-safe.
struct RcanProbe {
  /// Of the last scrape.
  metrics::Cell series;
  metrics::Cell robots_left_out;
  metrics::Cell bytes;
  metrics::LatencyDistribution scrape_seconds{metrics::kLatencyBoundsSeconds};
  /// Scrapes that got nothing because kTextsMax were still being read.
  metrics::Cell refused_total;
};

}  // namespace uplink::rcan
