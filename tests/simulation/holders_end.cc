// What HoldersWorld promises: after each tick, and once everything had the time to settle.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/store/lease_judge.h"
#include "tests/simulation/holders_world.h"

namespace uplink::simulation {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

/// Robots come back to a process, and processes to the store.
constexpr seconds kCalm{40};
/// The silence of a lease, the grace of a start, and the rounds between.
constexpr seconds kSettles{30 + 120 + 30};
constexpr seconds kSlack{15};
/// A standstill that the end of troubles cuts short may be too short for a grace.
constexpr seconds kBack{1};
/// What an adoption means for a robot is looked at for so long.
constexpr seconds kShownAfter{30};
/// Longer than anything here takes.
constexpr std::chrono::hours kParkedFor{9};

robot::StateSnapshot SnapshotOf(const robot::Robot& robot) {
  return robot.state.Snapshot(robot::RobotState::Parts::kNone);
}

}  // namespace

void HoldersWorld::CheckAdopted(const std::string& ruri, const HoldersTruth::Hold& hold) {
  const HoldersTruth::Began& began = truth_.BeganOf(ruri);
  if (clock_.Steady() - began.at > kShownAfter || !truth_.MayBeHeardAtFormer(ruri, hold.holder))
    return;
  for (const Place& place : places_) {
    if (place.process == nullptr || place.process->id() != hold.holder) continue;
    const robot::Robot& there = *place.process->fleet().Find(ruri);
    const robot::StateSnapshot shown = SnapshotOf(there);
    // What is since then was judged, and is written.
    if (there.state.held_since() != hold.since || shown.presence_since >= began.system_at) continue;
    if (shown.presence != model::Presence::kOffline) continue;
    truth_.Fail(fmt::format("{} shows {} offline, and one that had it before may hear it",
                            place.process->name(), ruri));
  }
}

void HoldersWorld::CheckHolds() {
  for (const auto& [ruri, hold] : truth_.Holds()) {
    CheckAdopted(ruri, hold);
    for (const Place& place : places_) {
      const fleet::RobotPtr robot =
          place.process == nullptr ? nullptr : place.process->fleet().Find(ruri);
      if (robot == nullptr || robot->state.held_since() < hold.since) continue;
      if (place.process->id() == hold.holder) continue;
      if (truth_.IsLost(ruri, place.process->id(), robot->state.held_since())) continue;
      truth_.Fail(fmt::format("{} believes that it holds {}", place.process->name(), ruri));
    }
  }
}

void HoldersWorld::Settle() {
  settling_ = true;
  const SteadyTime now = clock_.Steady();
  truth_.Tell("troubles end");
  goes_back_at_.reset();
  for (Place& place : places_) {
    place.still_until = place.unread_until = place.cut_until = now;
    place.lost_percent = 0;
    for (Place::HalfOpen& open : place.half_open) open.ends_at = now;
    if (place.process == nullptr) place.starts_at = now;
  }
  for (Robot& robot : robots_) {
    if (robot.broke) robot.connects_at = std::min(robot.connects_at, now + kBack);
  }
  Pass(kCalm);
  for (Robot& robot : robots_) {
    if (random_.Percent(30) && SayGoodbye(robot)) Leave(robot, seconds(1));
  }
  // They are back, perhaps elsewhere.
  Pass(kCalm);
  for (Robot& robot : robots_) robot.parked_until.reset();
  for (Robot& robot : robots_) {
    if (!robot.link || !random_.Percent(30)) continue;
    if (random_.Percent(50)) static_cast<void>(SayGoodbye(robot));
    FallSilent(robot, std::chrono::hours(10));
  }
  Pass(kSettles);
  CheckEnd();
  if (options_.seed % 4 != 0) return;
  Pass(kHoldersAdoptedGrace);
  CheckEnd();
}

bool HoldersWorld::SayGoodbye(Robot& robot) {
  const std::string& ruri = robot.id->ruri;
  Place* const place = robot.link ? PlaceOf(robot) : nullptr;
  const auto holds = truth_.Holds();
  const auto hold = holds.find(ruri);
  if (place == nullptr || !IsHeard(robot) || hold == holds.end()) return false;
  if (hold->second.holder != place->process->id()) return false;
  robot.parked_until = clock_.System() + kParkedFor;
  truth_.Tell(fmt::format("{} says Goodbye", ruri));
  place->process->Park(ruri, *robot.parked_until);
  return true;
}

void HoldersWorld::CheckEnd() {
  if (!truth_.violation().empty()) return;
  const auto holds = truth_.Holds();
  for (const Robot& robot : robots_) {
    const std::string& ruri = robot.id->ruri;
    const auto hold = holds.find(ruri);
    if (hold == holds.end()) continue;
    const auto holder = std::ranges::find_if(places_, [&](const Place& place) {
      return place.process != nullptr && place.process->id() == hold->second.holder;
    });
    if (holder == places_.end()) {
      truth_.Fail(fmt::format("no process adopted {}", ruri));
      continue;
    }
    CheckEndOf(robot, *holder->process, hold->second.since);
    CheckElsewhere(robot, *holder->process);
    if (AnyMayCome()) continue;
    if (truth_.RowsOf(ruri).size() == robot.changes) continue;
    truth_.Fail(fmt::format("{} has {} rows for {} changes", ruri, truth_.RowsOf(ruri).size(),
                            robot.changes));
  }
}

void HoldersWorld::CheckEndOf(const Robot& robot, HoldersProcess& holder, storage::Epoch since) {
  const std::string& ruri = robot.id->ruri;
  const robot::Robot& there = *holder.fleet().Find(ruri);
  const robot::StateSnapshot shown = SnapshotOf(there);
  if (there.state.held_since() != since || shown.foreign) {
    truth_.Fail(fmt::format("{} does not know that it holds {}", holder.name(), ruri));
  }
  using model::Presence;
  const bool streams = robot.speaks_at <= clock_.Steady() + kSlack;
  if (streams && (!robot.link || PlaceOf(robot)->process.get() != &holder)) {
    truth_.Fail(fmt::format("{} does not stream to {}, which holds it", ruri, holder.name()));
  }
  const bool right = streams ? shown.presence == Presence::kOnline
                             : shown.presence == Presence::kOffline ||
                                   (shown.presence == Presence::kUnknown && MayBeUnknown(robot));
  if (!right) {
    truth_.Fail(fmt::format("{} is {} at {}", ruri, model::ToText(shown.presence), holder.name()));
  }
  if (shown.parked_until != robot.parked_until) {
    truth_.Fail(fmt::format("{} is {} at {}", ruri, shown.parked_until ? "parked" : "not parked",
                            holder.name()));
  }
  const auto& rows = truth_.RowsOf(ruri);
  const Presence last = rows.empty() ? Presence::kUnknown : rows.back().presence;
  // Who was offline at a holder that fell silent is shown as unknown, and that is not written.
  const bool is_shown_alone = last == Presence::kOffline && shown.presence == Presence::kUnknown;
  if (last != shown.presence && !is_shown_alone) {
    truth_.Fail(fmt::format("the last row of {} says {}, and {} says {}", ruri, model::ToText(last),
                            holder.name(), model::ToText(shown.presence)));
  }
}

bool HoldersWorld::AnyLooksCut() const {
  return std::ranges::any_of(database_.ReadLeases(), [this](const storage::Lease& lease) {
    const bool lives = std::ranges::any_of(places_, [&](const Place& place) {
      return place.process != nullptr && place.process->id() == lease.process;
    });
    return !lives && !lease.released && !gone_.contains(lease.card.life) &&
           truth_.RenewedAgo(lease.process) <= kHoldersAdoptedGrace + kSlack;
  });
}

bool HoldersWorld::MayBeUnknown(const Robot& robot) {
  if (!robot.link && AnyLooksCut()) return true;
  const HoldersTruth::Began& began = truth_.BeganOf(robot.id->ruri);
  if (!began.adopted || clock_.Steady() > began.at + kHoldersAdoptedGrace + kSlack) return false;
  // One of those before may live.
  if (!began.ended_fresh || began.chained) return true;
  // Only processes on its own machine see that a process was killed.
  return *began.ended_fresh == HoldersTruth::End::kKilled && !places_[began.from[0] - 1U].seen;
}

void HoldersWorld::CheckElsewhere(const Robot& robot, const HoldersProcess& holder) {
  const std::string& ruri = robot.id->ruri;
  const auto& rows = truth_.RowsOf(ruri);
  // Others look now and then.
  if (!rows.empty() && clock_.System() - rows.back().at <= 2 * store::kLookEvery) return;
  const model::Presence last = rows.empty() ? model::Presence::kUnknown : rows.back().presence;
  for (const Place& place : places_) {
    if (place.process == nullptr || place.process.get() == &holder) continue;
    const fleet::RobotPtr there = place.process->fleet().Find(ruri);
    if (there == nullptr) {
      truth_.Fail(fmt::format("{} does not know {}", place.process->name(), ruri));
      continue;
    }
    const robot::StateSnapshot shown = SnapshotOf(*there);
    if (shown.foreign && shown.foreign->held_by == holder.name() && shown.presence == last &&
        shown.parked_until == robot.parked_until) {
      continue;
    }
    truth_.Fail(fmt::format("{} shows {} as {} of {}", place.process->name(), ruri,
                            model::ToText(shown.presence),
                            shown.foreign ? shown.foreign->held_by : "itself"));
  }
}

}  // namespace uplink::simulation
