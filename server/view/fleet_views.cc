// Fleets in figures, and the robots that send most.
#include <algorithm>
#include <map>
#include <utility>

#include <absl/status/status.h>

#include "server/view/page_token.h"
#include "server/view/queries.h"

namespace uplink::view {
namespace {

/// One robot counts in its fleet.
void Count(const robot::Robot& robot, const Glance& glance, const FaultCounts::Map* faults,
           FleetView& fleet) {
  ++fleet.robots;
  fleet.presence.Count(robot.state.presence(), robot.state);
  if (glance.vitals.estop.value_or(false)) ++fleet.estops;
  if (!glance.agent_version.empty()) ++fleet.agent_versions[glance.agent_version];
  if (!glance.software_version.empty()) ++fleet.software_versions[glance.software_version];
  if (faults == nullptr) return;
  FaultCounts::BySeverity& sums =
      fleet.active_faults ? *fleet.active_faults : fleet.active_faults.emplace();
  const auto counts = faults->find(robot.ruri());
  if (counts == faults->end()) return;
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += counts->second[i];
}

/// Names the versions of most robots; the rest count as one.
void BoundVersions(std::map<std::string, std::int64_t>& versions) {
  if (versions.size() <= kVersionsMax) return;
  std::vector<std::pair<std::int64_t, std::string>> by_count;
  by_count.reserve(versions.size());
  for (const auto& [version, robots] : versions) by_count.emplace_back(robots, version);
  std::ranges::sort(by_count, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  versions.clear();
  for (std::size_t i = 0; i < by_count.size(); ++i) {
    const bool is_named = i < kVersionsMax;
    versions[is_named ? by_count[i].second : std::string(kOtherVersions)] += by_count[i].first;
  }
}

}  // namespace

absl::StatusOr<FleetsPage> Queries::Fleets(const FleetsQuery& query) {
  std::string after;
  if (!query.page_token.empty()) {
    std::optional<std::string> name = FleetFromToken(query.page_token);
    if (!name) return absl::InvalidArgumentError("pageToken is not one that this list gave");
    after = *std::move(name);
  }
  const Seen seen = See(true);
  const RobotsFilter filter{.fleets = query.fleets};
  FilteredRobots filtered(filter, true);
  filtered.SetSources(FilterSourcesOf(seen));
  std::map<std::string, FleetView> fleets;
  const std::shared_ptr<const SortedRobots::List> sorted = sorted_.Get();
  for (const SortedRobots::Entry& entry : *sorted) {
    const fleet::RobotPtr robot = entry.robot.lock();
    if (robot == nullptr) continue;
    Glance glance;
    if (filtered.Look(*robot, entry.short_name, glance) == FilteredRobots::Match::kNo) continue;
    std::string name = robot->id()->fleet;
    if (name > after) Count(*robot, glance, seen.faults.get(), fleets[std::move(name)]);
  }
  FleetsPage page;
  for (auto& [name, fleet] : fleets) {
    if (page.fleets.size() >= query.page_size) {
      page.next_token = FleetsToken(page.fleets.back().fleet);
      break;
    }
    fleet.fleet = name;
    BoundVersions(fleet.agent_versions);
    BoundVersions(fleet.software_versions);
    page.fleets.push_back(std::move(fleet));
  }
  return page;
}

std::vector<fleet::TopSenders::Sender> Queries::Top(fleet::TopBy by, std::size_t count,
                                                    const std::vector<std::string>& fleets) const {
  if (sources_.top == nullptr) return {};
  return sources_.top->Most(by, count, fleets);
}

std::vector<fleet::Candidate> Queries::Candidates(std::size_t count,
                                                  const std::vector<std::string>& fleets) const {
  std::vector<fleet::Candidate> all = sources_.fleet.entry().candidates().All();
  std::erase_if(all, [&fleets](const fleet::Candidate& candidate) {
    return !fleets.empty() && std::ranges::find(fleets, candidate.robot.fleet) == fleets.end();
  });
  all.resize(std::min(all.size(), count));
  return all;
}

}  // namespace uplink::view
