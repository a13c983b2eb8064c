#include "server/fleet/samples.h"

namespace uplink::fleet {

void AddSamples(const Fleet& fleet, metrics::Exposition& page) {
  using enum metrics::MetricId;
  const PresenceCounts counts = fleet.presence_counts();
  page.Add(kRobots, counts.online, {"online"});
  page.Add(kRobots, counts.offline, {"offline"});
  page.Add(kRobots, counts.unknown, {"unknown"});
  page.Add(kRobotsElsewhere, counts.elsewhere);
  page.Add(kRobotsLimit, fleet.robots_max());
}

}  // namespace uplink::fleet
