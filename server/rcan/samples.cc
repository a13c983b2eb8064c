#include "server/rcan/samples.h"

namespace uplink::rcan {

void AddSamples(const RcanProbe& probe, std::size_t series_max, metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kRcanSeries, probe.series);
  page.Add(kRcanSeriesLimit, series_max);
  page.Add(kRcanRobotsLeftOut, probe.robots_left_out);
  page.Add(kRcanRobotsIncomplete, probe.robots_incomplete);
  page.Add(kRcanSeriesLeftOut, probe.series_over_max_total, {"robot_series_max"});
  page.Add(kRcanSeriesLeftOut, probe.series_new_names_total, {"robot_new_names_max"});
  page.Add(kRcanSeriesLeftOut, probe.series_no_room_total, {"series_max"});
  page.Add(kRcanScrapeSeconds, probe.scrape_seconds);
  page.Add(kRcanScrapeBytes, probe.bytes);
  page.Add(kRcanScrapesRefused, probe.refused_total);
}

}  // namespace uplink::rcan
