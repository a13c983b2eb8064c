#include "server/fleet/samples.h"

#include <string_view>

namespace uplink::fleet {

namespace {

void AddTally(metrics::MetricId metric, std::string_view fleet, const PresenceTally& tally,
              metrics::Exposition& page) {
  page.Add(metric, tally.online, {fleet, "online"});
  page.Add(metric, tally.offline - tally.parked, {fleet, "offline"});
  page.Add(metric, tally.parked, {fleet, "parked"});
  page.Add(metric, tally.unknown, {fleet, "unknown"});
}

}  // namespace

void AddSamples(const Fleet& fleet, metrics::Exposition& page) {
  using enum metrics::MetricId;
  for (const auto& [name, tally] : fleet.fleet_tallies()) {
    AddTally(kRobots, name, tally.here, page);
    AddTally(kRobotsElsewhere, name, tally.elsewhere, page);
    page.Add(kRobotsFlapping, tally.here.flapping, {name});
    page.Add(kRobotCertificatesExpiring, tally.certificates_expiring,
             {name, kCertificateExpiringText});
  }
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
