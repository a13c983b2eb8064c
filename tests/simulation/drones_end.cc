// The end of a run: troubles stop, and everything must settle.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "tests/simulation/drones_world.h"

namespace uplink::simulation {
namespace {

/// Rounds after which a run that has not settled never will; each lets half a second pass, and an
/// adoption may take half a minute.
constexpr int kRoundsMax = 300;
constexpr milliseconds kRound{500};
/// Of a store's steps and calls' wakes in a round.
constexpr int kTurnsMax = 200;
/// Live samples that a drone takes for a sign to go elsewhere.
constexpr int kUnavailableMax = 3;
constexpr auto kShownTypes = std::to_array<SampleType>(
    {SampleType::kHeading, SampleType::kArmed, SampleType::kFlightMode,
     SampleType::kUncrewFlightMode, SampleType::kAlerts, SampleType::kOperatorRequests});

}  // namespace

std::string ToText(const DronesResult& result) {
  std::string text = fmt::format(
      "violation {}\nsteps {}\nlost answers {}\nlate calls {}\nmoves {}\nkills {}\nstops {}\n"
      "breaks {}\nclaims {}\nfenced {}\nduplicates {}\n",
      result.violation, result.steps, result.lost_answers, result.late_calls, result.moves,
      result.kills, result.stops, result.breaks, result.claims, result.fenced, result.duplicates);
  for (const auto& [end, count] : result.ends) text += fmt::format("{}: {}\n", end, count);
  return text;
}

void DronesWorld::Settle() {
  Tell("settles");
  for (Place& place : places_) {
    if (place.stops_at) Stop(place);
    if (place.process == nullptr) Start(place);
    place.away_until = clock_.Steady();
    place.process->line().FailNext(StoreFault::kNone);
    place.process->line().SetAway(false);
  }
  for (Drone& drone : drones_) drone.alternates = false;
  // What was sent before, late calls among it; then each drone's last word.
  for (const bool last_word : {false, true}) {
    for (Drone& drone : drones_) drone.said.clear();
    int rounds = 0;
    while (result_.violation.empty() && !Settled(last_word)) {
      if (++rounds > kRoundsMax) return Violate("troubles have stopped and not everything settles");
      for (Drone& drone : drones_) Speak(drone, last_word);
      SettleRound();
    }
  }
}

void DronesWorld::Speak(Drone& drone, bool last_word) {
  SimDrone& aboard = *drone.aboard;
  const std::size_t index = IndexOf(drone);
  if (std::ranges::any_of(calls_, [index](const auto& each) {
        return each.second.drone == index && each.second.awaited;
      })) {
    return;
  }
  if (drone.unavailable >= kUnavailableMax) {
    drone.unavailable = 0;
    drone.place = (drone.place + 1) % places_.size();
  }
  for (const DroneSampleRef& sample : aboard.Pending()) Send(drone, sample);
  if (!last_word) return;
  drone.said.clear();
  Send(drone, aboard.MakeHeading(clock_.Steady()));
  for (const SampleType type : kRepeatedTypes) {
    if (const auto sample = aboard.Repeat(type, clock_.Steady())) Send(drone, sample);
  }
}

void DronesWorld::SettleRound() {
  std::vector<std::uint64_t> ids;
  for (const auto& [id, call] : calls_) ids.push_back(id);
  for (const std::uint64_t id : ids) {
    const auto call = calls_.find(id);
    if (call == calls_.end()) continue;
    if (call->second.at == Call::At::kOnItsWay) CallStep(id);
    if (calls_.contains(id) && !call->second.awaited) CallStep(id);
  }
  for (Place& place : places_) {
    for (int turn = 0; turn < kTurnsMax; ++turn) {
      const bool wrote = place.process->Write();
      const bool wakes = place.process->HasWakes();
      if (wakes) place.process->DeliverWake(random_.Below(1'000));
      if (!wrote && !wakes) break;
    }
  }
  Reap();
  for (const std::uint64_t id : ids) {
    const auto call = calls_.find(id);
    if (call != calls_.end() && call->second.at == Call::At::kAnswered) Receive(id);
  }
  Pass(kRound);
  Check();
}

bool DronesWorld::Settled(bool last_word) const {
  if (!calls_.empty()) return false;
  for (const Place& place : places_) {
    if (!place.process->idle()) return false;
  }
  return std::ranges::all_of(drones_, [this, last_word](const Drone& drone) {
    if (!drone.aboard->Pending().empty()) return false;
    if (!last_word) return true;
    // It was told so after it spoke.
    if (places_[drone.place].process->HeldElsewhere(drone.aboard->ruri())) return false;
    return drone.said.contains(SampleType::kHeading) &&
           std::ranges::all_of(kRepeatedTypes,
                               [&drone](SampleType type) { return drone.said.contains(type); });
  });
}

void DronesWorld::CheckEnd() {
  for (const Place& place : places_) {
    const auto in_flight = place.process->counts().in_flight;
    if (in_flight == 0) continue;
    Violate(
        fmt::format("all is settled and {} are in flight at {}", in_flight, place.process->name()));
  }
  for (const Drone& drone : drones_) {
    const SimDrone& aboard = *drone.aboard;
    for (const DroneSampleRef& sample : aboard.made()) {
      const bool is_told = sample->kind() == model::uncrew::SampleKind::kDurable;
      if (!is_told || IsSetType(sample->type) || book_.Has(aboard.ruri(), *sample)) continue;
      Violate(fmt::format("{}'s {} was never stored", aboard.ruri(), ToText(*sample)));
    }
    CheckShown(drone);
  }
  if (const auto difference = book_.Compare(backend_.ReaderAt(0))) Violate(*difference);
}

void DronesWorld::CheckShown(const Drone& drone) {
  const SimDrone& aboard = *drone.aboard;
  const DronesProcess& process = *places_[drone.place].process;
  const uncrew::DronePtr shown = process.Find(aboard.ruri());
  if (shown == nullptr || process.HeldElsewhere(aboard.ruri())) {
    return Violate(fmt::format("{} is not shown at {}", aboard.ruri(), process.name()));
  }
  shown->LookAt([&](const uncrew::LiveSamples& live) {
    std::map<SampleType, storage::SampleDigest> last;
    for (const DroneSampleRef& sample : aboard.made()) last[sample->type] = sample->digest;
    for (const SampleType type : kShownTypes) {
      const uncrew::LiveSample* newest = live.Newest(type);
      if (newest != nullptr && newest->digest == last[type]) continue;
      Violate(fmt::format("{} shows another {} than the latest", aboard.ruri(),
                          model::uncrew::RowOf(type).name));
    }
    std::set<std::string> waiting;
    for (const auto& [id, since] : live.requests()) waiting.insert(id);
    if (waiting != aboard.requests()) {
      Violate(fmt::format("{} shows requests {}", aboard.ruri(), fmt::join(waiting, " ")));
    }
  });
}

}  // namespace uplink::simulation
