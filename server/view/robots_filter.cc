#include "server/view/robots_filter.h"

#include <algorithm>
#include <utility>

namespace uplink::view {
namespace {

/// Of ASCII letters: other characters of a RURI are percent-encoded.
char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string LowerOf(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), Lower);
  return lower;
}

/// Whether it asks about what MatchesValues compares.
bool AsksForValues(const RobotsFilter& filter) {
  return filter.battery_below || filter.bbox || !filter.software.empty() || filter.estop;
}

bool Is(const std::optional<bool>& value, bool wanted) { return value && *value == wanted; }

}  // namespace

std::string ShortNameOf(std::string_view ruri) {
  std::size_t begin = ruri.rfind('/');
  if (begin != std::string_view::npos && begin > 0) begin = ruri.rfind('/', begin - 1);
  return LowerOf(begin == std::string_view::npos ? ruri : ruri.substr(begin + 1));
}

FilteredRobots::FilteredRobots(const RobotsFilter& filter, const FilterSources& sources,
                               bool with_glances)
    : filter_(filter),
      sources_(sources),
      q_(LowerOf(filter.q)),
      looks_(with_glances || NeedsGlances(filter)) {}

bool FilteredRobots::NeedsGlances(const RobotsFilter& filter) {
  return AsksForValues(filter) || filter.held_back || filter.faulted ||
         filter.certificate_expires_before;
}

FilteredRobots::Match FilteredRobots::Look(const robot::Robot& robot, std::string_view short_name,
                                           Glance& glance) {
  if (!MatchesName(robot, short_name) || !MatchesPresence(robot)) return Match::kNo;
  if (!looks_) return Match::kYes;
  if (robot.state.foreign()) return LookAtForeign(robot, glance);
  glance = GlanceOf(robot, sources_.live);
  const bool held_back = robot.sessions.held_back() != robot::HeldBack::kNone;
  if (filter_.held_back && held_back != *filter_.held_back) return Match::kNo;
  if (filter_.faulted && HasFaults(robot, glance) != *filter_.faulted) return Match::kNo;
  if (!MatchesCertificate(glance)) return Match::kNo;
  return MatchesValues(glance) ? Match::kYes : Match::kNo;
}

bool FilteredRobots::MatchesName(const robot::Robot& robot, std::string_view short_name) const {
  if (!q_.empty() && short_name.find(q_) == std::string_view::npos) return false;
  return filter_.fleet.empty() || robot.id()->fleet == filter_.fleet;
}

bool FilteredRobots::MatchesPresence(const robot::Robot& robot) const {
  if (!filter_.presence && !filter_.offline_before) return true;
  const robot::Presence presence = robot.state.presence();
  if (filter_.presence && presence != *filter_.presence) return false;
  if (!filter_.offline_before) return true;
  return presence == robot::Presence::kOffline &&
         robot.state.presence_since() < *filter_.offline_before;
}

bool FilteredRobots::HasFaults(const robot::Robot& robot, const Glance& glance) const {
  if (glance.faulted) return true;
  return sources_.faults != nullptr && sources_.faults->contains(robot.ruri());
}

bool FilteredRobots::MatchesValues(const Glance& glance) const {
  const Vitals& vitals = glance.vitals;
  if (filter_.battery_below &&
      (!vitals.battery_percent || *vitals.battery_percent >= *filter_.battery_below)) {
    return false;
  }
  if (filter_.bbox && (!vitals.place || !filter_.bbox->Contains(vitals.place->latitude_deg,
                                                                vitals.place->longitude_deg))) {
    return false;
  }
  if (!filter_.software.empty() && glance.agent_version != filter_.software &&
      glance.software_version != filter_.software) {
    return false;
  }
  return !filter_.estop || Is(vitals.estop, *filter_.estop);
}

bool FilteredRobots::MatchesCertificate(const Glance& glance) const {
  if (!filter_.certificate_expires_before) return true;
  return glance.certificate_not_after &&
         *glance.certificate_not_after < *filter_.certificate_expires_before;
}

FilteredRobots::Match FilteredRobots::LookAtForeign(const robot::Robot& robot,
                                                    Glance& glance) const {
  bool is_known = false;
  if (sources_.foreign != nullptr) {
    const auto found = sources_.foreign->find(robot.ruri());
    is_known = found != sources_.foreign->end();
    if (is_known) glance = found->second;
  }
  // Active faults are in the store, also those of others' robots.
  const bool has_faults = HasFaults(robot, glance);
  const bool knows_faults = is_known || has_faults;
  if (filter_.faulted && knows_faults && has_faults != *filter_.faulted) return Match::kNo;
  if (is_known && !MatchesValues(glance)) return Match::kNo;
  // The other process alone has its connection, and so what holds that back.
  if (filter_.held_back || filter_.certificate_expires_before) return Match::kUnknown;
  if (!is_known && AsksForValues(filter_)) return Match::kUnknown;
  return filter_.faulted && !knows_faults ? Match::kUnknown : Match::kYes;
}

}  // namespace uplink::view
