#pragma once

#include "metrics/cells.h"

namespace uplink::rcan {

/// Counts of the robots' scrapes. Thread-safe.
struct RcanProbe {
  // Of the last scrape; where several scopes are scraped, the largest (ScopeCounts).
  metrics::Cell series;
  metrics::Cell robots_left_out;
  /// Robots without some of their series.
  metrics::Cell robots_incomplete;
  metrics::Cell bytes;
  metrics::LatencyDistribution scrape_seconds{metrics::kLatencyBoundsSeconds};
  /// Series that are missing though their robot is there, by reason; each scrape counts them again.
  metrics::Cell series_over_max_total;
  metrics::Cell series_new_names_total;
  metrics::Cell series_no_room_total;
  /// Scrapes that got nothing because kTextsMax were still being read.
  metrics::Cell refused_total;
};

}  // namespace uplink::rcan
