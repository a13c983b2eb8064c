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

/// What conditions say of one robot together.
class Verdict final {
 public:
  /// Whether it meets one more; empty: what that asks about is unknown.
  void Add(std::optional<bool> meets) {
    unknown_ = unknown_ || !meets;
    no_ = no_ || (meets && !*meets);
  }
  [[nodiscard]] bool no() const { return no_; }
  [[nodiscard]] bool unknown() const { return unknown_; }

 private:
  bool no_ = false;
  bool unknown_ = false;
};

template <typename Value>
std::optional<bool> IsBelow(const std::optional<Value>& value, const Value& bound) {
  if (!value) return std::nullopt;
  return *value < bound;
}

std::optional<bool> Is(const std::optional<bool>& value, bool wanted) {
  if (!value) return std::nullopt;
  return *value == wanted;
}

std::optional<bool> IsWithin(const std::optional<Vitals::Place>& place, const BoundingBox& box) {
  if (!place) return std::nullopt;
  return box.Contains(place->latitude_deg, place->longitude_deg);
}

std::optional<bool> Runs(const Glance& glance, const std::string& version) {
  if (glance.agent_version == version || glance.software_version == version) return true;
  // An agentInfo tells both.
  if (glance.agent_version.empty()) return std::nullopt;
  return false;
}

/// The process that has its stream knows.
std::optional<bool> IsHeldBack(const RobotFacts& facts) {
  if (facts.glance.foreign) return std::nullopt;
  return facts.held_back;
}

}  // namespace

std::string ShortNameOf(std::string_view ruri) {
  std::size_t begin = ruri.rfind('/');
  if (begin != std::string_view::npos && begin > 0) begin = ruri.rfind('/', begin - 1);
  return LowerOf(begin == std::string_view::npos ? ruri : ruri.substr(begin + 1));
}

FilteredRobots::FilteredRobots(const RobotsFilter& filter, bool with_glances)
    : filter_(filter),
      q_(LowerOf(filter.q)),
      looks_(with_glances || filter.values != ValuesFilter() || filter.set != SetFilter()) {}

FilteredRobots::Match FilteredRobots::Look(const robot::Robot& robot, std::string_view short_name,
                                           Glance& glance) {
  const storage::RobotRef id = robot.id();
  if (!MatchesName(robot.ruri(), id->fleet, short_name)) return Match::kNo;
  RobotFacts facts{
      .ruri = robot.ruri(), .fleet = id->fleet, .short_name = short_name, .glance = glance};
  if (AsksForPresence()) {
    facts.presence = robot.state.presence();
    facts.presence_since = robot.state.presence_since();
    if (!MatchesPresence(facts.presence, facts.presence_since)) return Match::kNo;
  }
  if (!looks_) return Match::kYes;
  if (!MatchesSet(robot.ruri())) return Match::kNo;
  glance = GlanceOf(robot, sources_.live);
  if (filter_.values.held_back) {
    facts.held_back = robot.sessions.held_back() != robot::HeldBack::kNone;
  }
  return MatchesValues(facts);
}

FilteredRobots::Match FilteredRobots::Judge(const RobotFacts& facts) const {
  if (!MatchesName(facts.ruri, facts.fleet, facts.short_name)) return Match::kNo;
  if (!MatchesPresence(facts.presence, facts.presence_since)) return Match::kNo;
  if (!looks_) return Match::kYes;
  if (!MatchesSet(facts.ruri)) return Match::kNo;
  return MatchesValues(facts);
}

bool FilteredRobots::MatchesName(std::string_view ruri, std::string_view fleet,
                                 std::string_view short_name) const {
  const auto& ruris = filter_.ruris;
  if (!ruris.empty() && !std::binary_search(ruris.begin(), ruris.end(), ruri)) return false;
  if (!q_.empty() && short_name.find(q_) == std::string_view::npos) return false;
  return storage::LooksAt(filter_.fleets, fleet);
}

bool FilteredRobots::AsksForPresence() const { return filter_.presence || filter_.offline_before; }

bool FilteredRobots::MatchesPresence(robot::Presence presence, SystemTime since) const {
  if (filter_.presence && presence != *filter_.presence) return false;
  if (!filter_.offline_before) return true;
  return presence == robot::Presence::kOffline && since < *filter_.offline_before;
}

bool FilteredRobots::MatchesSet(std::string_view ruri) const {
  const auto& [labels, blocked] = filter_.set;
  if (labels.empty() && !blocked) return true;
  const fleet::RobotSettingPtr set =
      sources_.settings == nullptr ? nullptr : sources_.settings->Find(ruri);
  if (blocked && *blocked != (set != nullptr && set->blocked)) return false;
  return std::ranges::all_of(labels, [&set](const auto& label) {
    if (set == nullptr) return false;
    const auto found = set->labels.find(label.first);
    return found != set->labels.end() && found->second == label.second;
  });
}

FilteredRobots::Match FilteredRobots::MatchesValues(const RobotFacts& facts) const {
  // Names each condition: this does not compile while one is missing.
  const auto& [battery_below, bbox, software, held_back, estop, faulted, expires_before] =
      filter_.values;
  const Vitals& vitals = facts.glance.vitals;
  Verdict verdict;
  if (battery_below) verdict.Add(IsBelow(vitals.battery_percent, *battery_below));
  if (bbox) verdict.Add(IsWithin(vitals.place, *bbox));
  if (!software.empty()) verdict.Add(Runs(facts.glance, software));
  if (held_back) verdict.Add(Is(IsHeldBack(facts), *held_back));
  if (estop) verdict.Add(Is(vitals.estop, *estop));
  if (faulted) verdict.Add(Is(HasFaults(facts), *faulted));
  if (expires_before) {
    verdict.Add(IsBelow(facts.glance.certificate_not_after, *expires_before));
  }
  if (verdict.no()) return Match::kNo;
  if (!verdict.unknown()) return Match::kYes;
  return facts.glance.foreign ? Match::kUnknown : Match::kNo;
}

std::optional<bool> FilteredRobots::HasFaults(const RobotFacts& facts) const {
  // The store has the active faults of all robots.
  if (sources_.faults != nullptr && sources_.faults->contains(std::string(facts.ruri))) return true;
  return facts.glance.faulted;
}

}  // namespace uplink::view
