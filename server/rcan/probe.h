#pragma once

#include "metrics/cells.h"

namespace uplink::rcan {

/// What the robots' scrapes count. Thread-safe.
struct RcanProbe {
  /// Of the last scrape.
  metrics::Cell series;
  metrics::Cell robots_left_out;
  /// Robots of which some series are not there.
  metrics::Cell robots_incomplete;
  metrics::Cell bytes;
  metrics::LatencyDistribution scrape_seconds{metrics::kLatencyBoundsSeconds};
  /// Series that are not there though their robot is, by why; each scrape counts them again.
  metrics::Cell series_over_max_total;
  metrics::Cell series_new_names_total;
  metrics::Cell series_no_room_total;
  /// Scrapes that got nothing because kTextsMax were still being read.
  metrics::Cell refused_total;
};

}  // namespace uplink::rcan
