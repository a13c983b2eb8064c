#include "server/fleet/samples.h"

namespace uplink::fleet {

namespace {

void AddTally(metrics::MetricId metric, const PresenceTally& tally, metrics::Exposition& page) {
  page.Add(metric, tally.online, {"online"});
  page.Add(metric, tally.offline, {"offline"});
  page.Add(metric, tally.unknown, {"unknown"});
}

}  // namespace

void AddSamples(const Fleet& fleet, metrics::Exposition& page) {
  using enum metrics::MetricId;
  const PresenceCounts counts = fleet.presence_counts();
  AddTally(kRobots, counts, page);
  AddTally(kRobotsElsewhere, counts.elsewhere, page);
  page.Add(kRobotsParked, counts.parked, {"here"});
  page.Add(kRobotsParked, counts.elsewhere.parked, {"elsewhere"});
  page.Add(kRobotsFlapping, counts.flapping, {"here"});
  page.Add(kRobotsFlapping, counts.elsewhere.flapping, {"elsewhere"});
  page.Add(kRobotsLimit, fleet.robots_max());
  page.Add(kRobotsLeaving, fleet.leaving());
  page.Add(kRobotsForgotten, fleet.forgotten());
}

void AddSamples(const LiveBudget& budget, metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kLiveBytes, budget.bytes());
  page.Add(kLiveBytesLimit, budget.bytes_max());
  page.Add(kLivePartsDropped, budget.parts_dropped());
}

}  // namespace uplink::fleet
