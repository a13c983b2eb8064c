// What must hold after every step, and of every answer.
#include <algorithm>

#include <fmt/format.h>

#include "server/uncrew/limits.h"
#include "tests/simulation/drones_world.h"

namespace uplink::simulation {

namespace pb = ::uncrew::v1;
using model::uncrew::SampleKind;

namespace {

/// Within which a call is answered, and a timer may be late.
constexpr milliseconds kAnsweredWithin = kAnswerWithin + milliseconds(500);
constexpr std::uint64_t kOlderMaxUs =
    static_cast<std::uint64_t>(std::chrono::microseconds(uncrew::kOlderMax).count());

}  // namespace

void DronesWorld::Check() {
  for (const Place& place : places_) {
    if (place.process != nullptr && !place.process->counts().Balanced()) {
      Violate("the conservation law is broken at " + place.process->name());
    }
  }
  for (const auto& [id, call] : calls_) {
    if (call.at != Call::At::kServed) continue;
    if (clock_.Steady() - call.served_since > kAnsweredWithin) {
      Violate(fmt::format("{}'s {} waits for longer than uncrew.answer_within", NameOf(call),
                          ToText(*call.sample)));
    }
  }
}

std::optional<DronesWorld::Held> DronesWorld::HeldOf(const DronesProcess& process,
                                                     const std::string& ruri,
                                                     const DroneSample& sample) {
  std::optional<Held> held;
  const uncrew::DronePtr drone = process.Find(ruri);
  if (drone == nullptr) return held;
  drone->LookAt([&](const uncrew::LiveSamples& live) {
    for (const uncrew::LiveSample& part : live.Of(sample.type)) {
      if (part.key == sample.key) held = Held{part.digest, part.metadata.boot_us};
    }
  });
  return held;
}

void DronesWorld::CheckLive(const Call& call, const std::optional<Held>& held) {
  const DroneSample& sample = *call.sample;
  if (sample.kind() != SampleKind::kLive || sample.bad) return;
  const DronesProcess& process = *ProcessOf(call);
  const bool elsewhere = process.HeldElsewhere(NameOf(call));
  const bool is_old =
      held && (held->digest == sample.digest ||
               (sample.boot_us < held->boot_us && held->boot_us - sample.boot_us <= kOlderMaxUs));
  const auto after = HeldOf(process, NameOf(call), sample);
  const bool is_held = after && after->digest == sample.digest;
  bool fits = false;
  if (call.end.status.code() == absl::StatusCode::kUnavailable) {
    fits = elsewhere;
  } else if (call.end.Is(pb::OUTCOME_APPLIED)) {
    fits = !elsewhere && !is_old && is_held;
  } else if (call.end.Is(pb::OUTCOME_SUPERSEDED)) {
    fits = !elsewhere && is_old;
  } else {
    fits = call.end.status.code() == absl::StatusCode::kResourceExhausted;
  }
  if (fits) return;
  Violate(fmt::format("{}'s {} is {}: it is {}, {} held now, and the drone is {}", NameOf(call),
                      ToText(sample), ToText(call.end), is_old ? "old" : "new",
                      is_held ? "is" : "is not", elsewhere ? "another's" : "ours"));
}

void DronesWorld::CheckEndOf(const Call& call) {
  Tell(fmt::format("{}.{} answers {}'s {}: {}", call.place, call.life, NameOf(call),
                   ToText(*call.sample), ToText(call.end)));
  const auto violates = [&](const char* why) {
    Violate(fmt::format("{}'s {} is {}, and {}", NameOf(call), ToText(*call.sample),
                        ToText(call.end), why));
  };
  const bool is_live = call.sample->kind() == SampleKind::kLive && !call.sample->bad;
  switch (call.end.status.code()) {
    case absl::StatusCode::kOk:
      if (!is_live) CheckStored(call);
      return;
    case absl::StatusCode::kUnavailable:
      if (is_live || places_[call.place].stops_at) return;
      // A mode that says the same is live: the drone was another server's when it came.
      if (call.sample->kind() == SampleKind::kDurableOnChange) return;
      if (clock_.Steady() - call.served_since < kAnswerWithin) violates("it did not wait");
      return;
    case absl::StatusCode::kResourceExhausted:
      if (std::ranges::count_if(calls_, [&call](const auto& other) {
            return other.second.drone == call.drone && other.second.place == call.place;
          }) <= static_cast<std::ptrdiff_t>(uncrew::kCallsInFlightMax)) {
        violates("it has few calls");
      }
      return;
    default:
      violates("nothing called for it");
  }
}

void DronesWorld::CheckStored(const Call& call) {
  const DroneSample& sample = *call.sample;
  const CallEnd& end = call.end;
  const auto violates = [&](const char* why) {
    Violate(fmt::format("{}'s {} is {}, and {}", NameOf(call), ToText(sample), ToText(end), why));
  };
  const bool is_rejected = end.Is(pb::OUTCOME_REJECTED);
  if (is_rejected != sample.bad) return violates(sample.bad ? "it is bad" : "it is good");
  const bool says_stored = end.Is(pb::OUTCOME_STORED) || end.Is(pb::OUTCOME_DUPLICATE);
  // One of a live type is answered before its row is committed.
  const bool must_be_kept = says_stored || (is_rejected && sample.kind() != SampleKind::kLive);
  if (must_be_kept && !book_.Has(NameOf(call), sample)) {
    return violates("the store has it not");
  }
  const bool is_set = IsSetType(sample.type);
  const bool changes = is_set || sample.kind() == SampleKind::kDurableOnChange;
  if (!says_stored && !is_rejected && !changes) return violates("its type is always stored");
  if (is_set && end.Is(pb::OUTCOME_APPLIED)) return violates("a set is never live");
  if (changes) CheckLastWord(call);
}

void DronesWorld::CheckLastWord(const Call& call) {
  const DroneSample& sample = *call.sample;
  // Of others that are on their way, or were, one may have come later.
  if (!sample.alone || !drones_[call.drone].aboard->Awaits(sample)) return;
  if (IsSetType(sample.type)) {
    const std::set<std::string>& active = book_.Active(NameOf(call), sample.type);
    if (active == sample.items) return;
    return Violate(fmt::format("{}'s {} is {} and says {}, and the store has {}", NameOf(call),
                               ToText(sample), ToText(call.end), fmt::join(sample.items, " "),
                               fmt::join(active, " ")));
  }
  const std::string last = book_.Mode(NameOf(call), sample.type).value_or("nothing");
  if (last == sample.mode) return;
  Violate(fmt::format("{}'s {} is {} and says {}, and the store has {}", NameOf(call),
                      ToText(sample), ToText(call.end), sample.mode, last));
}

}  // namespace uplink::simulation
