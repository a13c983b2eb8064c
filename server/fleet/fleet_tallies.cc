#include "server/fleet/fleet_tallies.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace uplink::fleet {

void PresenceTally::Count(robot::Presence presence, const robot::RobotState& state) {
  if (state.flapping()) ++flapping;
  switch (presence) {
    case robot::Presence::kUnknown:
      ++unknown;
      break;
    case robot::Presence::kOnline:
      ++online;
      break;
    case robot::Presence::kOffline:
      ++offline;
      if (state.parked_until()) ++parked;
      break;
  }
}

PresenceTally& PresenceTally::operator+=(const PresenceTally& other) {
  unknown += other.unknown;
  online += other.online;
  offline += other.offline;
  parked += other.parked;
  flapping += other.flapping;
  return *this;
}

FleetTally& FleetTally::operator+=(const FleetTally& other) {
  here += other.here;
  elsewhere += other.elsewhere;
  certificates_expiring += other.certificates_expiring;
  return *this;
}

void ShownFleets::Fill(const FleetTallies& tallies) {
  std::vector<std::pair<std::int64_t, std::string>> waiting;
  for (const auto& [name, tally] : tallies) {
    if (!shown_.contains(name)) waiting.emplace_back(-tally.robots(), name);
  }
  const std::size_t free = fleets_max_ - std::min(fleets_max_, shown_.size());
  const std::size_t taken = std::min(free, waiting.size());
  std::ranges::partial_sort(waiting, waiting.begin() + static_cast<std::ptrdiff_t>(taken));
  for (std::size_t i = 0; i < taken; ++i) shown_.insert(std::move(waiting[i].second));
}

FleetTallies ShownFleets::Fold(const FleetTallies& tallies) {
  std::erase_if(shown_, [&](const std::string& name) { return !tallies.contains(name); });
  Fill(tallies);
  FleetTallies folded;
  for (const auto& [name, tally] : tallies) {
    folded[shown_.contains(name) ? name : std::string(kOtherFleets)] += tally;
  }
  if (folded.empty()) folded.emplace(kOtherFleets, FleetTally());
  return folded;
}

}  // namespace uplink::fleet
