#include "tests/simulation/holders_world.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace uplink::simulation {
namespace {

constexpr milliseconds kTick{500};
/// Each step has a time of its own.
constexpr milliseconds kStep{1};
constexpr std::chrono::seconds kSpeaksEvery{1};
constexpr std::size_t kWritesMany = 50;
/// The transport's keepalive.
constexpr std::chrono::seconds kHalfOpenEnds{40};
/// A renewal was due, and the looks at it.
constexpr milliseconds kKnownAsCut =
    store::kLateAfter + store::kLookEvery + std::chrono::seconds(1);

}  // namespace

HoldersWorld::HoldersWorld(const HoldersOptions& options)
    : options_(options),
      random_(options.seed),
      truth_(clock_, database_, robot::PresenceLimits().timeout) {
  if (options_.fault == HoldersFault::kEpochsInEachRow) database_.CountEpochsInEachRow();
  places_.resize(2 + random_.Below(2));
  for (Place& place : places_) {
    place.seen = random_.Percent(50);
    place.starts_at = clock_.Steady();
  }
  robots_.resize(3 + random_.Below(3));
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    robots_[i].id = std::make_shared<const model::RobotId>(
        model::RobotId{fmt::format("rcan://{}", i), "fleet"});
    robots_[i].connects_at = clock_.Steady() + Between(milliseconds(0), std::chrono::seconds(20));
  }
}

milliseconds HoldersWorld::Between(milliseconds least, milliseconds most) {
  const auto range = static_cast<std::size_t>((most - least).count());
  return least + milliseconds(random_.Below(range + 1));
}

HoldersResult HoldersWorld::Run() {
  if (options_.trouble == HoldersOptions::Trouble::kFailovers && options_.seed % 3 == 0) {
    sessions_end_at_ = clock_.Steady();
  }
  Pass(std::chrono::minutes(15));
  Settle();
  result_.violation = truth_.violation();
  result_.lines = truth_.lines();
  result_.adoptions = truth_.adoptions();
  for (const Robot& robot : robots_) result_.rows += truth_.RowsOf(robot.id->ruri).size();
  return std::move(result_);
}

void HoldersWorld::Pass(milliseconds time) {
  const SteadyTime end = clock_.Steady() + time;
  while (clock_.Steady() < end && truth_.violation().empty()) Tick();
}

void HoldersWorld::Tick() {
  const SteadyTime end = clock_.Steady() + kTick;
  if (!settling_) Trouble();
  if (sessions_end_at_ && clock_.Steady() >= *sessions_end_at_) EndSessions();
  std::vector<std::size_t> turns(places_.size() + robots_.size());
  for (std::size_t i = 0; i < turns.size(); ++i) turns[i] = i;
  for (std::size_t left = turns.size(); left > 0; --left) {
    std::swap(turns[random_.Below(left)], turns[left - 1]);
    clock_.Advance(kStep);
    const std::size_t turn = turns[left - 1];
    if (turn < places_.size()) {
      StepOf(places_[turn]);
    } else {
      StepOf(robots_[turn - places_.size()]);
    }
  }
  CheckHolds();
  clock_.Advance(std::chrono::duration_cast<milliseconds>(end - clock_.Steady()));
}

bool HoldersWorld::Hears(const Place& place) const {
  return place.process != nullptr && clock_.Steady() >= place.unread_until && !Stands(place);
}

void HoldersWorld::StepOf(Place& place) {
  const SteadyTime now = clock_.Steady();
  if (place.process == nullptr) {
    if (place.starts_at && now >= *place.starts_at) Start(place);
    return;
  }
  if (Stands(place)) return;
  place.process->store().SetAway(!Reaches(place));
  place.process->store().SetLossy(place.lost_percent);
  if (Hears(place)) ReadEnds(place);
  if (Hears(place)) EndHalfOpen(place);
  if (place.stops_at && now >= *place.stops_at) {
    place.process->Stop();
    End(place);
    return;
  }
  std::size_t writes = kWritesMany;
  if (AnyMayCome() && !settling_ && random_.Percent(30)) {
    writes = random_.Below(4);
  }
  place.process->Step(writes, Hears(place));
}

void HoldersWorld::ReadEnds(Place& place) {
  for (const Place::UnreadEnd& end : std::exchange(place.unread_ends, {})) {
    truth_.Tell(fmt::format("{} reads that {} left{}", place.process->name(), end.ruri,
                            end.spoke ? ", and what it said before" : ""));
    if (end.spoke) place.process->HearLate(end.ruri);
    place.process->Close(end.ruri, end.stream);
  }
}

void HoldersWorld::EndHalfOpen(Place& place, std::string_view ruri) {
  std::erase_if(place.half_open, [&](const Place::HalfOpen& open) {
    if (clock_.Steady() < open.ends_at && open.ruri != ruri &&
        !place.process->Superseded(open.ruri, open.stream)) {
      return false;
    }
    place.process->Close(open.ruri, open.stream);
    return true;
  });
}

void HoldersWorld::NoteOnItsWay(const Robot& robot) {
  if (!robot.broke) return;
  const Place& place = places_[robot.broke->place];
  if (place.process == nullptr || place.lives != robot.broke->life || !Hears(place)) return;
  const storage::Epoch held_since = place.process->fleet().Find(robot.id->ruri)->state.held_since();
  // The store names another holder, which did not stand still and does not hear the robot.
  if (truth_.IsLost(robot.id->ruri, place.process->id(), held_since)) return;
  truth_.NoteSign(robot.id->ruri, place.process->id(), held_since);
}

bool HoldersWorld::IsKnownAsCut(const Place& place) const {
  return !Reaches(place) && clock_.Steady() - place.cut_since >= kKnownAsCut;
}

HoldersWorld::Place* HoldersWorld::PlaceOf(const Robot& robot) {
  Place& place = places_[robot.link->place];
  return place.process != nullptr && place.lives == robot.link->life ? &place : nullptr;
}

void HoldersWorld::StepOf(Robot& robot) {
  const SteadyTime now = clock_.Steady();
  if (!robot.link) {
    NoteOnItsWay(robot);
    if (now >= robot.connects_at) Connect(robot);
    return;
  }
  Place* place = PlaceOf(robot);
  if (place == nullptr) {
    robot.link.reset();
    robot.unread = false;
    robot.connects_at = std::max(robot.connects_at,
                                 now + Between(std::chrono::seconds(1), std::chrono::seconds(3)));
    return;
  }
  if (!Hears(*place)) {
    if (now < robot.speaks_at) return;
    if (!robot.unread) robot.unread_since = now;
    // It is there, whether or not anybody reads that; the process needs its time to notice that it
    // does not.
    if (now - robot.unread_since > fleet::kHandshakeEvery + fleet::kBehindAfter) {
      truth_.NoteSign(robot.id->ruri, place->process->id(),
                      place->process->fleet().Find(robot.id->ruri)->state.held_since());
    }
    robot.unread = true;
    robot.speaks_at = now + kSpeaksEvery;
    return;
  }
  if (place->process->Superseded(robot.id->ruri, robot.link->stream)) {
    Leave(robot, Between(std::chrono::seconds(1), std::chrono::seconds(3)));
    return;
  }
  if (robot.unread || now >= robot.speaks_at) Speak(robot, *place);
}

void HoldersWorld::Speak(Robot& robot, Place& place) {
  const SteadyTime now = clock_.Steady();
  place.process->Hear(robot.id->ruri);
  if (IsKnownAsCut(place)) truth_.NoteSignAtCut(robot.id->ruri, place.process->id());
  robot.unread = false;
  robot.heard_at = now;
  robot.speaks_at = std::max(robot.speaks_at, now + kSpeaksEvery);
  if (!robot.silent) return;
  robot.silent = false;
  ++robot.changes;
}

std::vector<std::size_t> HoldersWorld::Ready() const {
  std::vector<std::size_t> reaching;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Place& place = places_[i];
    if (!Serves(place)) continue;
    (Reaches(place) ? reaching : others).push_back(i);
  }
  return reaching.empty() ? others : reaching;
}

bool HoldersWorld::Serves(const Place& place) const {
  return Hears(place) && !place.stops_at && place.unread_ends.empty();
}

void HoldersWorld::Connect(Robot& robot) {
  std::vector<std::size_t> ready = Ready();
  for (std::size_t i = 0; i < places_.size() && random_.Percent(30); ++i) {
    if (Serves(places_[i]) && IsKnownAsCut(places_[i])) ready = {i};
  }
  if (ready.empty()) return;
  if (IsKnownAsCut(places_[ready.front()])) ++result_.moves_to_cut;
  const std::size_t index = ready[random_.Below(ready.size())];
  Place& place = places_[index];
  EndHalfOpen(place, robot.id->ruri);
  robot.link = Link{index, place.lives, place.process->Open(robot.id)};
  robot.broke.reset();
  truth_.Tell(fmt::format("{} connects to {}", robot.id->ruri, place.process->name()));
  robot.speaks_at =
      std::max(robot.speaks_at, clock_.Steady() + Between(milliseconds(0), kSpeaksEvery));
}

void HoldersWorld::Leave(Robot& robot, milliseconds pause) {
  Place* place = PlaceOf(robot);
  if (place != nullptr) {
    truth_.Tell(fmt::format("{} leaves {}", robot.id->ruri, place->process->name()));
  }
  if (place != nullptr && Hears(*place) && AnyMayCome() && random_.Percent(30)) {
    ++result_.half_open;
    truth_.Tell(robot.id->ruri + " leaves its connection half open");
    place->half_open.push_back(
        {robot.id->ruri, robot.link->stream, clock_.Steady() + kHalfOpenEnds});
  } else if (place != nullptr && Hears(*place)) {
    place->process->Close(robot.id->ruri, robot.link->stream);
  } else if (place != nullptr) {
    place->unread_ends.push_back({robot.id->ruri, robot.link->stream, robot.unread});
  }
  robot.link.reset();
  robot.unread = false;
  robot.connects_at = std::max(robot.connects_at, clock_.Steady() + pause);
}

}  // namespace uplink::simulation
