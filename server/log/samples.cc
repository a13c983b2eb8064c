#include "server/log/samples.h"

namespace uplink::log {

void AddSamples(const Logger& logger, metrics::Exposition& page) {
  using enum metrics::MetricId;
  const LineCounts counts = logger.counts();
  page.Add(kLogLinesWaiting, counts.waiting);
  page.Add(kLogLinesDropped, counts.dropped);
}

}  // namespace uplink::log
