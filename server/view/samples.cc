#include "server/view/samples.h"

#include "server/view/watches.h"

namespace uplink::view {

void AddSamples(const WatchProbe& probe, metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kWatches, probe.open);
  page.Add(kWatchesLimit, kWatchesMax);
  page.Add(kWatchesRefused, probe.refused);
  page.Add(kWatchesSlow, probe.slow);
  page.Add(kWatchRobotsShown, probe.shown);
  page.Add(kWatchRobotsRemoved, probe.removed);
}

}  // namespace uplink::view
