#include "tests/simulation/drones_world.h"

#include <algorithm>

#include <fmt/format.h>

namespace uplink::simulation {
namespace {

constexpr std::chrono::seconds kRepeatsEvery{1};
/// A process does something at least so often while time passes.
constexpr milliseconds kTickMax{500};

}  // namespace

DronesWorld::DronesWorld(DronesBackend& backend, const DronesOptions& options)
    : backend_(backend),
      options_(options),
      random_(options.seed),
      book_([this](const std::string& what) { Violate(what); }) {
  limits_.journal.bytes_max = random_.Percent(20) ? 4'000 : 1'000'000;
  limits_.journal.batch_records_max = 1 + random_.Below(12);
  limits_.in_flight_max = random_.Percent(30) ? 3 + random_.Below(6) : 1'000;
  limits_.presence = {.timeout = std::chrono::seconds(4),
                      .startup_grace = std::chrono::seconds(10)};
  places_.resize(backend_.places());
  for (Place& place : places_) Start(place);
  AddDrones();
}

void DronesWorld::AddDrones() {
  const std::size_t drones = 1 + random_.Below(4);
  for (std::size_t i = 0; i < drones; ++i) {
    const bool by_gateway = random_.Percent(25);
    drones_.push_back(
        {.aboard = std::make_unique<SimDrone>(
             i, by_gateway, [this, i](SampleType type) { return IsOnItsWay(i, type); }),
         .place = random_.Below(places_.size()),
         .alternates = random_.Percent(30),
         .repeats_at = clock_.Steady()});
  }
}

DronesResult DronesWorld::Run() {
  while (result_.steps < options_.steps && result_.violation.empty()) {
    ++result_.steps;
    Step();
    Reap();
    Check();
  }
  if (result_.violation.empty()) Settle();
  if (result_.violation.empty()) CheckEnd();
  result_.claims = book_.claims();
  result_.fenced = book_.fenced();
  result_.duplicates = book_.duplicates();
  if (options_.trace != nullptr) Tell(ToText(result_));
  return result_;
}

void DronesWorld::Violate(const std::string& what) {
  if (!result_.violation.empty()) return;
  result_.violation = fmt::format("seed {} step {}: {}", options_.seed, result_.steps, what);
  Tell("VIOLATION " + what);
}

void DronesWorld::Tell(const std::string& line) {
  if (options_.trace != nullptr) options_.trace->Add(line);
}

// --- Steps ---

void DronesWorld::Step() {
  const std::size_t pick = random_.Below(100);
  if (pick < 20) return DroneStep(drones_[random_.Below(drones_.size())]);
  if (pick < 55) {
    if (calls_.empty()) return;
    const auto which = static_cast<std::ptrdiff_t>(random_.Below(calls_.size()));
    return CallStep(std::next(calls_.begin(), which)->first);
  }
  if (pick < 92) {
    DronesProcess* const process = AnyPlace().process.get();
    if (process == nullptr) return;
    if (pick < 75) {
      static_cast<void>(process->Write());
    } else if (process->HasWakes()) {
      process->DeliverWake(random_.Below(1'000));
    }
    return;
  }
  if (pick < 97) {
    return Pass(milliseconds(random_.Percent(10) ? 6'000 : 20 + random_.Below(800)));
  }
  Trouble();
}

void DronesWorld::DroneStep(Drone& drone) {
  SimDrone& aboard = *drone.aboard;
  const SteadyTime now = clock_.Steady();
  const std::size_t pick = random_.Below(100);
  if (pick < 35) return Send(drone, aboard.MakeLive(now, random_));
  if (pick < 70) {
    if (const DroneSampleRef sample = aboard.Happen(now, random_)) Send(drone, sample);
    return;
  }
  if (pick < 95) {
    // What has no answer and waits for none is sent again; now and then what waits for one, too.
    for (const DroneSampleRef& sample : aboard.Pending()) {
      if (!IsOnItsWay(IndexOf(drone), sample->type) || random_.Percent(5)) Send(drone, sample);
    }
    if (now < drone.repeats_at) return;
    drone.repeats_at = now + kRepeatsEvery;
    for (const SampleType type : kRepeatedTypes) {
      if (const DroneSampleRef sample = aboard.Repeat(type, now)) Send(drone, sample);
    }
    return;
  }
  if (pick < 99) return BreakConnection(drone, drone.place);
  Tell(fmt::format("{} reboots", aboard.ruri()));
  aboard.Reboot();
}

void DronesWorld::Send(Drone& drone, const DroneSampleRef& sample) {
  book_.NoteMade(drone.aboard->ruri(), sample);
  if (drone.alternates) drone.place = random_.Below(places_.size());
  const Place& place = places_[drone.place];
  Tell(fmt::format("{} sends {} to {}.{}", drone.aboard->ruri(), ToText(*sample), drone.place,
                   place.lives));
  calls_.emplace(
      ++last_call_,
      Call{.drone = IndexOf(drone), .place = drone.place, .life = place.lives, .sample = sample});
}

void DronesWorld::CallStep(std::uint64_t id) {
  Call& call = calls_.at(id);
  DronesProcess* const process = ProcessOf(call);
  switch (call.at) {
    case Call::At::kOnItsWay:
      // A request that the drone gave up may arrive still.
      if (process == nullptr || process->draining() || (!call.awaited && random_.Percent(30))) {
        return Lose(calls_.find(id));
      }
      return Deliver(id, call);
    case Call::At::kServed:
      if (call.awaited || random_.Percent(60)) return;
      process->Break(id);
      return Lose(calls_.find(id));
    case Call::At::kAnswered:
      if (!call.awaited || random_.Percent(90)) return Receive(id);
      ++result_.lost_answers;
      return BreakConnection(drones_[call.drone], call.place);
  }
}

void DronesWorld::Deliver(std::uint64_t id, Call& call) {
  DronesProcess& process = *ProcessOf(call);
  if (!call.awaited) ++result_.late_calls;
  const auto held = HeldOf(process, NameOf(call), *call.sample);
  call.at = Call::At::kServed;
  call.served_since = clock_.Steady();
  process.Serve(id, drones_[call.drone].aboard->peer(), call.sample->type, call.sample->bytes);
  if (const auto end = process.TakeEnd(id)) {
    call.at = Call::At::kAnswered;
    call.end = *end;
    CheckLive(call, held);
    CheckEndOf(call);
  } else if (call.sample->kind() == model::uncrew::SampleKind::kLive && !call.sample->bad) {
    Violate(fmt::format("{}'s {} is live and waits", NameOf(call), ToText(*call.sample)));
  }
}

void DronesWorld::Reap() {
  for (auto& [id, call] : calls_) {
    DronesProcess* const process = ProcessOf(call);
    if (call.at != Call::At::kServed || process == nullptr) continue;
    const auto end = process->TakeEnd(id);
    if (!end) continue;
    call.at = Call::At::kAnswered;
    call.end = *end;
    CheckEndOf(call);
  }
}

void DronesWorld::Receive(std::uint64_t id) {
  const auto found = calls_.find(id);
  const Call call = found->second;
  calls_.erase(found);
  if (!call.awaited) return;
  ++result_.ends[ToText(call.end)];
  Drone& drone = drones_[call.drone];
  // A mode that says the same is live, too.
  if (call.sample->kind() != model::uncrew::SampleKind::kDurable) {
    const bool unavailable = call.end.status.code() == absl::StatusCode::kUnavailable;
    drone.unavailable = unavailable ? drone.unavailable + 1 : 0;
  }
  if (!call.end.status.ok()) return;
  drone.aboard->OnAnswered(*call.sample);
  drone.said.insert(call.sample->type);
}

void DronesWorld::Lose(Calls::iterator call) {
  Tell(fmt::format("{}'s call with {} ends without an answer", NameOf(call->second),
                   ToText(*call->second.sample)));
  if (call->second.awaited) ++result_.ends["lost"];
  calls_.erase(call);
}

void DronesWorld::BreakConnection(Drone& drone, std::size_t place) {
  ++result_.breaks;
  const std::size_t index = IndexOf(drone);
  Tell(fmt::format("{}'s connection breaks", drone.aboard->ruri()));
  for (auto& [id, call] : calls_) {
    if (call.drone == index && call.place == place) call.awaited = false;
  }
  // An answer without a waiter is dropped.
  std::erase_if(calls_, [](const auto& each) {
    return !each.second.awaited && each.second.at == Call::At::kAnswered;
  });
  if (!random_.Percent(50)) return;
  ++result_.moves;
  drone.place = random_.Below(places_.size());
}

bool DronesWorld::IsOnItsWay(std::size_t drone, SampleType type) const {
  return std::ranges::any_of(calls_, [drone, type](const auto& each) {
    const Call& call = each.second;
    return call.drone == drone && call.sample->type == type && call.at != Call::At::kAnswered;
  });
}

DronesProcess* DronesWorld::ProcessOf(const Call& call) {
  const Place& place = places_[call.place];
  return place.lives == call.life ? place.process.get() : nullptr;
}

void DronesWorld::Pass(milliseconds time) {
  for (; time > milliseconds(0); time -= std::min(time, kTickMax)) {
    clock_.Advance(std::min(time, kTickMax));
    const SteadyTime now = clock_.Steady();
    for (Place& place : places_) {
      if (place.process == nullptr) {
        if (place.starts_at && now >= *place.starts_at) Start(place);
        continue;
      }
      place.process->line().SetAway(now < place.away_until);
      place.process->Tick();
      const bool answered = place.process->serving() == 0;
      if (place.stops_at && (answered || now >= *place.stops_at)) Stop(place);
    }
    Reap();
  }
}

// --- Troubles ---

void DronesWorld::Trouble() {
  Place& place = AnyPlace();
  const std::size_t pick = random_.Below(100);
  if (pick < 10) {
    clock_.SetSystem(clock_.System() + std::chrono::seconds(random_.Below(200'000)) -
                     std::chrono::seconds(100'000));
    return;
  }
  if (place.process == nullptr) return;
  if (pick < 40) {
    place.process->line().FailNext(random_.Percent(50) ? StoreFault::kBefore : StoreFault::kAfter);
  } else if (pick < 60) {
    Tell("the store is away from " + place.process->name());
    place.away_until = clock_.Steady() + milliseconds(random_.Below(12'000));
    place.process->line().SetAway(true);
  } else if (pick < 75) {
    Tell("the connection to the store ends at " + place.process->name());
    backend_.Break(static_cast<std::size_t>(&place - places_.data()));
  } else if (pick < 88) {
    Kill(place);
  } else if (!place.stops_at) {
    Tell("stops " + place.process->name());
    const milliseconds grace(1 + random_.Below(3'000));
    place.process->Drain(grace);
    place.stops_at = clock_.Steady() + grace;
  }
}

void DronesWorld::Start(Place& place) {
  const auto index = static_cast<std::size_t>(&place - places_.data());
  ++place.lives;
  place.starts_at.reset();
  place.stops_at.reset();
  place.away_until = clock_.Steady();
  place.process = std::make_unique<DronesProcess>(DronesProcess::Ground{
      .clock = clock_,
      .backend = backend_,
      .book = book_,
      .trace = options_.trace,
      .place = index,
      .id = {static_cast<std::uint8_t>(index + 1), place.lives},
      .name = fmt::format("{}.{}", index, place.lives),
      .is_gone = [this](std::string_view life) { return gone_.contains(life); },
      .seed = random_.Next(),
      .limits = limits_});
  Tell("starts " + place.process->name());
  place.process->Tick();
}

void DronesWorld::Kill(Place& place) {
  ++result_.kills;
  Tell("kills " + place.process->name());
  End(place);
}

void DronesWorld::Stop(Place& place) {
  ++result_.stops;
  Reap();
  place.process->Stop();
  End(place);
}

void DronesWorld::End(Place& place) {
  if (random_.Percent(50)) gone_.insert(place.process->name());
  // What it said is said.
  place.process.reset();
  place.stops_at.reset();
  place.starts_at = clock_.Steady() + milliseconds(random_.Percent(70) ? 0 : random_.Below(40'000));
  LoseCallsOf(place);
}

void DronesWorld::LoseCallsOf(const Place& place) {
  const auto index = static_cast<std::size_t>(&place - places_.data());
  for (auto call = calls_.begin(); call != calls_.end();) {
    const auto next = std::next(call);
    if (call->second.place == index) Lose(call);
    call = next;
  }
  for (Drone& drone : drones_) {
    if (drone.place == index) drone.place = random_.Below(places_.size());
  }
}

}  // namespace uplink::simulation
