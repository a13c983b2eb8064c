// One robot, and the list of them.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include <absl/status/status.h>

#include "schema/cyberwave/ruri.h"
#include "server/view/drone_json.h"
#include "server/view/parts.h"
#include "server/view/queries.h"
#include "server/view/robots_order.h"
#include "server/view/twin_copy.h"
#include "storage/origin.h"

namespace uplink::view {
namespace {

robot::RobotState::Parts Wanted(const PartSet& parts) {
  using enum robot::RobotState::Parts;
  if (parts.AnyLarge()) return kAll;
  return parts.AnyLive() ? kSmall : kNone;
}

/// Of a robot that another process holds: the store has it because it opened a stream, or called.
/// The former leaves a session there.
bool SpokeByCallsAlone(const RobotView& view) {
  return view.state.foreign && !view.session.session && !cyberwave::IsTwinRuri(view.id.ruri);
}

/// A robot that matches, and where it stands.
struct Found {
  RobotsPlace place;
  fleet::RobotPtr robot;
};

/// The robots that come after a place. A list needs only the first of them.
class FoundRobots final {
 public:
  FoundRobots(const RobotsOrder& order, std::optional<RobotsPlace> after, std::size_t needed)
      : order_(order), after_(std::move(after)), needed_(needed) {}

  /// Robots are given by RURI.
  void Offer(const fleet::RobotPtr& robot, const Glance& glance) {
    // The first ones are enough if the list has this order.
    if (order_ == RobotsOrder() && found_.size() >= needed_) return;
    RobotsPlace place = PlaceOf(order_, robot->ruri(), glance);
    if (after_ && !ComesBefore(order_, *after_, place)) return;
    found_.push_back({.place = std::move(place), .robot = robot});
  }
  /// Those that are needed, in order.
  [[nodiscard]] std::vector<Found> Take() {
    const std::size_t first = std::min(needed_, found_.size());
    std::ranges::partial_sort(
        found_, found_.begin() + static_cast<std::ptrdiff_t>(first),
        [this](const Found& a, const Found& b) { return ComesBefore(order_, a.place, b.place); });
    found_.resize(first);
    return std::move(found_);
  }

 private:
  const RobotsOrder order_;
  const std::optional<RobotsPlace> after_;
  const std::size_t needed_;
  std::vector<Found> found_;
};

}  // namespace

RobotView Queries::Look(const robot::Robot& robot, const PartSet& parts) const {
  RobotView view{*robot.id(), robot.state.Snapshot(Wanted(parts)), robot.sessions.View(), 0, {}};
  if (!view.session.connected) {
    view.session.gateway = robot.calls.open() ? robot.speaker().value_or("") : "";
  }
  for (std::size_t kind = 0; kind < metrics::kKinds; ++kind) {
    view.rate_limited[kind] = robot.rates.limited(kind);
  }
  view.is_drone = robot.calls.spoke() || SpokeByCallsAlone(view);
  const auto foreign = view.state.foreign ? foreign_.glances() : nullptr;
  view.glance = GlanceOf(
      robot, {.twins = sources_.twins, .drones = sources_.drones, .foreign = foreign.get()});
  if (const auto expires = view.glance.certificate_not_after) {
    view.glance.certificate_days_left = static_cast<std::int32_t>(
        std::chrono::floor<std::chrono::days>(*expires - sources_.clock.System()).count());
  }
  if (sources_.settings != nullptr) view.set = sources_.settings->Find(robot.ruri());
  return view;
}

Queries::Seen Queries::See(bool with_faults) {
  const bool foreign = foreign_.due();
  const bool faults = with_faults && sources_.faults != nullptr && !sources_.faults->fresh();
  if (foreign || faults) {
    // Late or not, what it read is kept there, and the next list has it.
    static_cast<void>(brief_look_.Run([this, foreign, faults] {
      if (faults) static_cast<void>(sources_.faults->Refresh(sources_.fleet, sources_.reader));
      if (foreign) static_cast<void>(foreign_.Read());
    }));
  }
  Seen seen{.foreign = foreign_.glances(), .faults = nullptr};
  if (with_faults && sources_.faults != nullptr) seen.faults = sources_.faults->counts();
  return seen;
}

FilterSources Queries::FilterSourcesOf(const Seen& seen) const {
  return {
      .live = {.twins = sources_.twins, .drones = sources_.drones, .foreign = seen.foreign.get()},
      .faults = seen.faults.get(),
      .settings = sources_.settings};
}

std::size_t Queries::CopyLarge(RobotView& view, const PartSet& parts) const {
  std::size_t bytes = KeyedBytes(view.state.parts);
  if (parts.Has(Part::kCyberwave)) bytes += CopyTwin(sources_.twins, view);
  return bytes + CopyDrone(sources_.drones, parts.Has(Part::kUncrew), view);
}

absl::StatusOr<RobotsPage> Queries::Robots(const RobotsQuery& query) {
  std::optional<RobotsPlace> after;
  if (!query.page_token.empty()) {
    after = PlaceFromToken(query.order, query.page_token);
    if (!after) {
      return absl::InvalidArgumentError("pageToken is not one that this list gave in this order");
    }
  }
  const bool by_value = query.order.by != RobotsBy::kRuri;
  const bool by_faults = query.filter.values.faulted.has_value();
  FilteredRobots filter(query.filter, by_value);
  Seen seen;
  if (filter.looks()) seen = See(by_faults);
  filter.SetSources(FilterSourcesOf(seen));
  if (by_faults && sources_.faults != nullptr && seen.faults == nullptr) {
    return absl::UnavailableError("active faults are unknown while the store is away");
  }
  // One more shows whether another page follows.
  FoundRobots found(query.order, std::move(after), std::size_t{query.page_size} + 1);
  RobotsPage page;
  const std::shared_ptr<const SortedRobots::List> sorted = sorted_.Get();
  for (const SortedRobots::Entry& entry : *sorted) {
    const fleet::RobotPtr robot = entry.robot.lock();
    if (robot == nullptr) continue;
    Glance glance;
    const FilteredRobots::Match match = filter.Look(*robot, entry.short_name, glance);
    if (match == FilteredRobots::Match::kUnknown) ++page.unjudged;
    if (match != FilteredRobots::Match::kYes) continue;
    ++page.total;
    found.Offer(robot, glance);
  }
  std::size_t bytes = 0;
  for (const Found& each : found.Take()) {
    if (page.robots.size() >= query.page_size || bytes >= storage::kPageBytesMax) {
      page.next_token = page.robots.back().next_token;
      break;
    }
    RobotView& view = page.robots.emplace_back(Look(*each.robot, query.parts));
    view.next_token = TokenAfter(query.order, each.place);
    bytes += CopyLarge(view, query.parts);
  }
  if (absl::Status filled = FillPage(page, query.parts); !filled.ok()) return filled;
  return page;
}

absl::StatusOr<RobotView> Queries::Robot(const std::string& ruri,
                                         const std::vector<std::string>& fleets) {
  const fleet::RobotPtr robot = sources_.fleet.Find(ruri);
  if (robot == nullptr || storage::IsNoRobot(ruri)) return Unknown(ruri);
  if (!storage::LooksAt(fleets, robot->id()->fleet)) return Unknown(ruri);
  std::vector<RobotView> one;
  one.push_back(Look(*robot, PartSet::All()));
  CopyTwin(sources_.twins, one.front());
  CopyDrone(sources_.drones, true, one.front());
  FillRobot(one);
  return std::move(one.front());
}

}  // namespace uplink::view
