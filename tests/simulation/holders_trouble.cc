// What goes wrong in HoldersWorld, and what robots do by themselves.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tests/simulation/holders_world.h"

namespace uplink::simulation {

using std::chrono::minutes;
using std::chrono::seconds;

void HoldersWorld::Trouble() {
  switch (options_.trouble) {
    case HoldersOptions::Trouble::kNone:
      break;
    case HoldersOptions::Trouble::kUpdates:
      if (random_.Below(100) == 0) Update();
      break;
    case HoldersOptions::Trouble::kAll:
    case HoldersOptions::Trouble::kRows:
    case HoldersOptions::Trouble::kSuspends:
    case HoldersOptions::Trouble::kFailovers:
      if (random_.Below(60) == 0) AnyTrouble();
      break;
  }
  if (goes_back_at_ && clock_.Steady() >= *goes_back_at_) GoBack();
  for (Robot& robot : robots_) TroubleOf(robot);
}

void HoldersWorld::Update() {
  // Others are there, and no robot is about to be silent for too long by it.
  if (Ready().size() < places_.size()) return;
  if (!std::ranges::all_of(robots_, [this](const Robot& robot) { return IsHeard(robot); })) return;
  BeginStop(places_[random_.Below(places_.size())]);
}

void HoldersWorld::AnyTrouble() {
  Place& place = places_[random_.Below(places_.size())];
  switch (random_.Below(options_.trouble > HoldersOptions::Trouble::kAll ? 7 : 6)) {
    case 0:
      return Kill(place);
    case 1:
      return BeginStop(place);
    case 2:
      return StandStill(place);
    case 3:
      return Cut(place, random_.Percent(50) ? Between(seconds(3), seconds(40))
                                            : Between(seconds(40), minutes(10)));
    case 4: {
      const milliseconds away = Between(seconds(3), minutes(2));
      for (Place& each : places_) Cut(each, away);
      return;
    }
    case 6:
      if (options_.trouble == HoldersOptions::Trouble::kSuspends) return Suspend();
      if (options_.trouble == HoldersOptions::Trouble::kFailovers) return KeepCopy();
      return DeleteRow(robots_[random_.Below(robots_.size())]);
    default:
      place.lost_percent = static_cast<std::uint32_t>(random_.Below(3)) * 20;
  }
}

bool HoldersWorld::IsHeard(const Robot& robot) const {
  const SteadyTime now = clock_.Steady();
  return robot.link && robot.heard_at && now - *robot.heard_at < seconds(2) &&
         robot.speaks_at - now < seconds(2);
}

void HoldersWorld::TroubleOf(Robot& robot) {
  if (!robot.link) return;
  Place* place = PlaceOf(robot);
  if (place == nullptr) return;
  if (!Hears(*place)) {
    // It is not answered, and may try another one.
    if (random_.Below(60) == 0) Leave(robot, seconds(1));
    return;
  }
  // What it does next comes after it was heard.
  if (!IsHeard(robot)) return;
  switch (random_.Below(300)) {
    case 0:
      if (options_.trouble != HoldersOptions::Trouble::kUpdates) {
        FallSilent(robot, Between(seconds(20), seconds(120)));
      }
      return;
    case 1:
      return FallSilent(robot, Between(seconds(3), seconds(6)));
    case 2: {
      // While no process reaches the store it stays where it is.
      const std::vector<std::size_t> ready = Ready();
      if (ready.empty() || !Reaches(places_[ready.front()])) return;
      ++result_.moves;
      return Leave(robot, Between(seconds(1), seconds(3)));
    }
    default:
      return;
  }
}

void HoldersWorld::FallSilent(Robot& robot, milliseconds time) {
  const SteadyTime until = clock_.Steady() + time;
  truth_.Tell(fmt::format("{} is silent for {} ms", robot.id->ruri, time.count()));
  if (time > robot::PresenceLimits().timeout && !std::exchange(robot.silent, true)) {
    ++robot.changes;
  }
  robot.speaks_at = until;
  if (!random_.Percent(50)) return;
  robot.connects_at = until;
  Leave(robot, milliseconds(0));
}

void HoldersWorld::Start(Place& place) {
  const auto index = static_cast<std::uint8_t>(&place - places_.data());
  ++place.lives;
  place.starts_at.reset();
  place.lost_percent = 0;
  place.process = std::make_unique<HoldersProcess>(HoldersProcess::Ground{
      .clock = clock_,
      .boot = boot_,
      .database = database_,
      .truth = truth_,
      .random = random_,
      .fault = options_.fault,
      .id = {static_cast<std::uint8_t>(index + 1), place.lives},
      .name = fmt::format("{}.{}", index + 1, place.lives),
      .is_gone = [this](std::string_view life) { return gone_.contains(life); },
      .peer_answers =
          [this, index, life = place.lives](const std::string& ruri, std::uint64_t stream) {
            return std::ranges::any_of(robots_, [&](const Robot& robot) {
              return robot.id->ruri == ruri && robot.link && robot.link->place == index &&
                     robot.link->life == life && robot.link->stream == stream;
            });
          }});
  truth_.Tell("starts " + place.process->name());
  place.process->store().SetAway(!Reaches(place));
  place.process->Start();
}

void HoldersWorld::End(Place& place) {
  if (place.seen) gone_.insert(place.process->name());
  place.process.reset();
  place.stops_at.reset();
  place.unread_ends.clear();
  place.half_open.clear();
  place.still_until = place.unread_until = clock_.Steady();
  place.starts_at = clock_.Steady() + Between(seconds(0), seconds(90));
}

void HoldersWorld::Kill(Place& place) {
  if (place.process == nullptr) return;
  ++result_.kills;
  truth_.Tell("killed " + place.process->name());
  truth_.NoteEnded(place.process->id(), HoldersTruth::End::kKilled);
  End(place);
}

void HoldersWorld::BeginStop(Place& place) {
  if (!Hears(place) || place.stops_at) return;
  ++result_.stops;
  truth_.Tell("stops " + place.process->name());
  ReadEnds(place);
  for (Robot& robot : robots_) {
    if (robot.link && PlaceOf(robot) == &place) Leave(robot, Between(seconds(1), seconds(3)));
  }
  // A drain waits for its streams.
  for (Place::HalfOpen& open : place.half_open) open.ends_at = clock_.Steady();
  EndHalfOpen(place);
  place.process->draining = true;
  place.stops_at = clock_.Steady() + Between(seconds(1), seconds(5));
}

void HoldersWorld::StandStill(Place& place) {
  if (place.process == nullptr || Stands(place)) return;
  ++result_.standstills;
  milliseconds time = Between(seconds(1), seconds(20));
  if (random_.Percent(50))
    time = Between(seconds(20), random_.Percent(50) ? seconds(70) : minutes(5));
  place.still_until = clock_.Steady() + time;
  place.unread_until = place.still_until + Between(seconds(0), seconds(15));
  truth_.Tell(fmt::format("stands still {} for {} ms", place.process->name(), time.count()));
  if (time >= fleet::Fleet::kStandstillBreaks + seconds(1)) BreakConnections(place);
}

void HoldersWorld::BreakConnections(Place& place) {
  ++result_.long_standstills;
  const auto still = std::chrono::duration_cast<milliseconds>(place.unread_until - clock_.Steady());
  for (Robot& robot : robots_) {
    if (!robot.link || PlaceOf(robot) != &place || !IsHeard(robot) || random_.Percent(50)) continue;
    robot.broke = robot.link;
    // What it said before its agent gave up is read afterwards.
    robot.unread = true;
    Leave(robot, still + Between(seconds(1), seconds(60)));
  }
}

void HoldersWorld::Suspend() {
  ++result_.suspends;
  const milliseconds time = Between(minutes(1), minutes(10));
  truth_.Tell(fmt::format("suspended for {} ms", time.count()));
  boot_.Suspend(time);
  clock_.SetSystem(clock_.System() + time);
  for (Robot& robot : robots_) {
    if (!robot.link || PlaceOf(robot) == nullptr || !IsHeard(robot)) continue;
    robot.broke = robot.link;
    Leave(robot, Between(seconds(1), seconds(60)));
  }
}

void HoldersWorld::KeepCopy() {
  if (goes_back_at_) return;
  copy_.CopyRowsOf(database_);
  truth_.KeepCopy();
  goes_back_at_ = clock_.Steady() + Between(milliseconds(500), seconds(20));
}

void HoldersWorld::GoBack() {
  ++result_.failovers;
  goes_back_at_.reset();
  const auto before = truth_.Holds();
  database_.CopyRowsOf(copy_);
  truth_.GoBack(before);
  // The connections to the one before are lost, and a standby takes a while to take over.
  const milliseconds away = random_.Percent(50) ? milliseconds(0) : Between(seconds(0), minutes(1));
  for (Place& place : places_) {
    if (place.process != nullptr) place.process->store().Break();
    Cut(place, away + Between(milliseconds(0), seconds(5)));
  }
}

void HoldersWorld::EndSessions() {
  ++result_.session_ends;
  for (Place& place : places_) {
    if (place.process != nullptr) place.process->store().Break();
  }
  sessions_end_at_ = clock_.Steady() + Between(seconds(1), seconds(4));
}

void HoldersWorld::DeleteRow(const Robot& robot) {
  if (database_.EpochOf(robot.id->ruri) == 0) return;
  ++result_.deletions;
  truth_.Tell(fmt::format("the row of {} is deleted", robot.id->ruri));
  database_.DeleteRobotRow(robot.id->ruri);
}

void HoldersWorld::Cut(Place& place, milliseconds time) {
  ++result_.cuts;
  if (Reaches(place)) place.cut_since = clock_.Steady();
  place.cut_until = std::max(place.cut_until, clock_.Steady() + time);
  truth_.Tell(fmt::format("cut {} for {} ms", &place - places_.data() + 1, time.count()));
}

}  // namespace uplink::simulation
