#include "server/view/watched_robots.h"

#include <utility>

#include <absl/hash/hash.h>

#include "server/view/robot_mark.h"
#include "storage/origin.h"

namespace uplink::view {
namespace {

/// With the active faults, which the store has.
std::uint64_t MarkWithFaults(const robot::Robot& robot, const FilterSources& sources) {
  std::uint64_t faults = 0;
  if (sources.faults != nullptr) {
    const auto found = sources.faults->find(robot.ruri());
    if (found != sources.faults->end()) {
      for (const auto count : found->second) faults += static_cast<std::uint64_t>(count);
    }
  }
  const fleet::RobotSettingPtr set =
      sources.settings == nullptr ? nullptr : sources.settings->Find(robot.ruri());
  return absl::HashOf(MarkOf(robot, sources.live), faults, set == nullptr ? 0 : set->version);
}

void Tell(const robot::Robot& robot, std::size_t number, std::string_view short_name,
          const FilterSources& sources, bool with_glances, const WatchedRobots::OnRobot& tell) {
  const Glance glance = with_glances ? GlanceOf(robot, sources.live) : Glance();
  const storage::RobotRef id = robot.id();
  const RobotFacts facts{.ruri = robot.ruri(),
                         .fleet = id->fleet,
                         .short_name = short_name,
                         .presence = robot.state.presence(),
                         .presence_since = robot.state.presence_since(),
                         .held_back = robot.sessions.held_back() != robot::HeldBack::kNone,
                         .glance = glance};
  tell({.number = number, .facts = facts});
}

}  // namespace

void WatchedRobots::LookAgain(const FilterSources& sources, bool with_glances, const OnGone& gone,
                              const OnRobot& changed) {
  Follow(gone);
  for (std::size_t number = 0; number < entries_.size(); ++number) {
    Entry& entry = entries_[number];
    const fleet::RobotPtr robot = entry.robot.lock();
    if (robot == nullptr) continue;  // the next look at the fleet shows that it is gone
    const std::uint64_t mark = MarkWithFaults(*robot, sources);
    if (std::exchange(entry.mark, mark) == mark) continue;
    Tell(*robot, number, entry.short_name, sources, with_glances, changed);
  }
}

void WatchedRobots::ForEach(const FilterSources& sources, bool with_glances,
                            const OnRobot& each) const {
  for (std::size_t number = 0; number < entries_.size(); ++number) {
    const Entry& entry = entries_[number];
    const fleet::RobotPtr robot = entry.robot.lock();
    if (robot != nullptr) {
      Tell(*robot, number, entry.short_name, sources, with_glances, each);
    }
  }
}

void WatchedRobots::Follow(const OnGone& gone) {
  // Read first: a robot that comes meanwhile is a change that the next look sees.
  const std::uint64_t changes = fleet_.changes() + 1;
  if (std::exchange(followed_, changes) == changes) return;
  std::vector<bool> is_there(entries_.size(), false);
  std::vector<fleet::RobotPtr> fresh;
  for (const fleet::RobotPtr& robot : fleet_.Sorted()) {
    if (storage::IsNoRobot(robot->ruri())) continue;
    const auto known = by_ruri_.find(robot->ruri());
    if (known == by_ruri_.end()) {
      fresh.push_back(robot);
      continue;
    }
    // It may have left, and come again.
    entries_[known->second].robot = robot;
    is_there[known->second] = true;
  }
  for (std::size_t number = 0; number < is_there.size(); ++number) {
    Entry& entry = entries_[number];
    if (is_there[number] || entry.free()) continue;
    gone(number, entry.ruri);
    by_ruri_.erase(entry.ruri);
    entry = Entry();
    free_.push_back(number);
  }
  for (const fleet::RobotPtr& robot : fresh) Add(robot);
}

void WatchedRobots::Add(const fleet::RobotPtr& robot) {
  std::size_t number = entries_.size();
  if (free_.empty()) {
    entries_.emplace_back();
  } else {
    number = free_.back();
    free_.pop_back();
  }
  entries_[number] = {
      .robot = robot, .ruri = robot->ruri(), .short_name = ShortNameOf(robot->ruri())};
  by_ruri_.emplace(robot->ruri(), number);
}

void WatchedRobots::Clear() {
  entries_.clear();
  free_.clear();
  by_ruri_.clear();
  followed_ = 0;
}

}  // namespace uplink::view
