#include "server/uncrew/drone.h"

#include <algorithm>
#include <utility>

#include "schema/uncrew/records.h"
#include "server/robot/limits.h"
#include "server/uncrew/drone_message.h"
#include "server/uncrew/limits.h"

namespace uplink::uncrew {

using model::uncrew::SampleKind;
using model::uncrew::SampleType;

namespace {

Answer LimitedBy(const DroneMessage& message) {
  return {.outcome = Outcome::kRejected,
          .rejection = message.limited(),
          .retry_after = message.retry_after()};
}

bool IsGood(Outcome outcome) {
  return outcome == Outcome::kApplied || outcome == Outcome::kSuperseded;
}

}  // namespace

Drone::Drone(const Context& context, fleet::RobotPtr robot)
    : context_(context), robot_(std::move(robot)) {
  robot_->calls.Begin();
}

Drone::~Drone() {
  robot_->calls.EndWaiting(waiting_.use());
  robot_->calls.End();
}

// --- Who calls ---

bool Drone::SetSpeaker(const fleet::Claim& claim) {
  const bool moves = claim.grant != fleet::Grant::kFleet;
  const bool same = robot_->id()->fleet == claim.robot.fleet;
  if (!same && !moves) return false;
  const std::lock_guard lock(mutex_);
  claim_.SpeakAs(claim, moves, context_.journal);
  if (!same) {
    robot_->SetFleet(claim.robot.fleet);
    claim_.TellFleet(waiting_.empty());
  }
  return true;
}

bool Drone::Enter(SystemTime now) {
  if (calls_.fetch_add(1) >= kCallsInFlightMax) {
    calls_.fetch_sub(1);
    return false;
  }
  called_at_ms_.store(UnixMs(now));
  robot_->NoteHeard(now);
  return true;
}

bool Drone::idle() const {
  const std::lock_guard lock(mutex_);
  return calls_.load() == 0 && waiting_.empty() && !claim_.is_asked();
}

// --- A sample ---

Drone::Offered Drone::Offer(ingest::Port& port, const Sample& sample, loop::StreamRef caller) {
  const std::lock_guard lock(mutex_);
  // It is to be forgotten: what it says comes again, to a drone that is new.
  if (robot_->calls.asked_to_end()) return Settle(port, sample, metrics::Became::kRefused);
  ClaimIfDue(context_.clock.Steady());
  if (claim_.is_other_fleet()) {
    static_cast<void>(Settle(port, sample, metrics::Became::kRefused));
    return {.is = Offered::Is::kOtherFleet};
  }
  const bool is_foreign = robot_->state.foreign();
  if (sample.judged.decoded && !is_foreign) {
    port.NoteLife(line(), sample.arrived, sample.arrived_system);
  }
  if (sample.judged.rejection() != nullptr) return OfferDurable(port, sample, caller);
  // Sets are shown at once, whatever the store does.
  if (IsSet(sample.judged.type) && !is_foreign && !live_.IsOlder(sample.live())) {
    live_.Apply(sample.live());
  }
  if (sample.row().kind == SampleKind::kLive) return OfferLive(port, sample);
  return OfferDurable(port, sample, caller);
}

Drone::Offered Drone::OfferLive(ingest::Port& port, const Sample& sample) {
  // Another server has it, and shows what it says live.
  if (robot_->state.foreign()) return Settle(port, sample, metrics::Became::kRefused);
  const LiveSamples::Sample live = sample.live();
  const bool is_old = live_.IsHeld(live) || live_.IsOlder(live);
  DroneMessage message({.judged = sample.judged,
                        .arrival = sample.arrival(),
                        .became = is_old ? metrics::Became::kSuperseded : metrics::Became::kApplied,
                        .rate = &rate_,
                        .now = context_.clock.Steady(),
                        .waiting = waiting_,
                        .ledger = context_.ledger});
  const ingest::Port::Offered offered = port.Offer(line(), message);
  port.Publish();
  if (offered.answer == ingest::Port::Answer::kLimited) return {.answer = LimitedBy(message)};
  if (!is_old) live_.Apply(live);
  return {.answer = {.outcome = is_old ? Outcome::kSuperseded : Outcome::kApplied}};
}

Drone::Offered Drone::OfferDurable(ingest::Port& port, const Sample& sample,
                                   loop::StreamRef caller) {
  if (claim_.epoch() == 0) return AwaitClaim(caller);
  const bool is_rejected = sample.judged.rejection() != nullptr;
  const SampleType type = is_rejected ? SampleType::kRejected : sample.judged.type;
  const auto mark = std::make_shared<const storage::SampleMark>(storage::SampleMark{
      .claim = claim_.epoch(),
      .type = NumberOf(type),
      .digest = sample.digest,
      .timed = sample.judged.metadata.timed(),
      .last = is_rejected ? std::string() : std::string(MemoryOf(type, sample.request))});
  const Answer if_known{.outcome = is_rejected ? Outcome::kRejected : Outcome::kDuplicate};
  if (const TicketRef ticket = waiting_.Find(mark->type, &mark->digest)) {
    port.Count(sample.arrival(), metrics::Became::kDuplicate);
    port.Publish();
    return Wait(ticket, if_known, caller);
  }
  if (stored_.IsDuplicate(*mark)) {
    static_cast<void>(Settle(port, sample, metrics::Became::kDuplicate));
    return AskStore(sample, if_known, caller);
  }
  const bool is_ordered =
      !is_rejected && (IsSet(type) || sample.row().kind != SampleKind::kDurable);
  if (is_ordered && live_.IsOlder(sample.live())) {
    return Settle(port, sample, metrics::Became::kSuperseded);
  }
  return OfferRecords(port, sample, mark, caller);
}

Drone::Offered Drone::OfferRecords(ingest::Port& port, const Sample& sample,
                                   const storage::SampleRef& mark, loop::StreamRef caller) {
  const bool is_rejected = sample.judged.rejection() != nullptr;
  std::vector<storage::CommitRecord> records;
  if (!is_rejected) {
    const SampleType type = sample.judged.type;
    const auto before = Recall(type, stored_.Last(type));
    records = sample.RecordsOf(Records::Of(sample.judged, before ? &*before : nullptr));
    if (records.empty()) return SaysTheSame(port, sample, caller);
  }
  // A rejected one of a live type takes the same tokens as a good one.
  const bool has_rate = is_rejected && sample.row().kind == SampleKind::kLive;
  DroneMessage message({.judged = sample.judged,
                        .arrival = sample.arrival(),
                        .mark = mark,
                        .records = std::move(records),
                        .rate = has_rate ? &rate_ : nullptr,
                        .now = context_.clock.Steady(),
                        .waiting = waiting_,
                        .ledger = context_.ledger});
  const robot::JournalUse before = waiting_.use();
  const ingest::Port::Offered offered = port.Offer(line(), message);
  port.Publish();
  if (offered.answer == ingest::Port::Answer::kWaits) return {.is = Offered::Is::kNoRoom};
  if (message.limited()) return {.answer = LimitedBy(message)};
  if (message.ticket() == nullptr) return {.answer = {.outcome = Outcome::kUnavailable}};
  AddWaitingSince(before);
  stored_.Add(*mark);
  if (!is_rejected && !robot_->state.foreign()) live_.Apply(sample.live());
  return Wait(message.ticket(), {.outcome = is_rejected ? Outcome::kRejected : Outcome::kStored},
              caller);
}

Drone::Offered Drone::SaysTheSame(ingest::Port& port, const Sample& sample,
                                  loop::StreamRef caller) {
  if (sample.row().kind == SampleKind::kDurableOnChange) {
    Offered live = OfferLive(port, sample);
    if (live.answer.outcome == Outcome::kRejected || live.answer.outcome == Outcome::kUnavailable)
      return live;
    return AskStore(sample, std::move(live.answer), caller);
  }
  Offered same = Settle(port, sample, metrics::Became::kSuperseded);
  // A drone may rely on the answer: the set is known once it is committed.
  const TicketRef ticket = waiting_.Find(NumberOf(sample.judged.type), nullptr);
  return ticket == nullptr ? AskStore(sample, same.answer, caller)
                           : Wait(ticket, same.answer, caller);
}

Drone::Offered Drone::AskStore(const Sample& sample, Answer answer, loop::StreamRef caller) {
  std::vector<storage::CommitRecord> question;
  question.push_back(QuestionOf({.robot = robot_->id(),
                                 .session = context_.session,
                                 .received_at = sample.arrived_system,
                                 .claim = claim_.epoch()}));
  const robot::JournalUse before = waiting_.use();
  const TicketRef ticket = waiting_.Add(question.front().sample, question, std::nullopt);
  AddWaitingSince(before);
  context_.journal.AppendMessage(*this, line().by, std::move(question), sample.arrived);
  return Wait(ticket, std::move(answer), caller);
}

void Drone::AddWaitingSince(const robot::JournalUse& before) {
  robot_->calls.AddWaiting({.records = waiting_.use().records - before.records,
                            .bytes = waiting_.use().bytes - before.bytes});
}

Drone::Offered Drone::Settle(ingest::Port& port, const Sample& sample, metrics::Became became) {
  port.Count(sample.arrival(), became);
  port.Publish();
  return {.answer = {.outcome = OutcomeOf(became)}};
}

Drone::Offered Drone::AwaitClaim(loop::StreamRef caller) {
  if (std::ranges::find(unclaimed_, caller) == unclaimed_.end()) unclaimed_.push_back(caller);
  return {.is = Offered::Is::kUnclaimed};
}

Drone::Offered Drone::Wait(const TicketRef& ticket, Answer answer, loop::StreamRef caller) {
  ticket->callers.push_back(caller);
  return {.is = Offered::Is::kWaits, .answer = std::move(answer), .ticket = ticket};
}

void Drone::Forget(const TicketRef& ticket, loop::StreamRef caller) {
  const std::lock_guard lock(mutex_);
  std::erase(unclaimed_, caller);
  if (ticket != nullptr) std::erase(ticket->callers, caller);
}

ingest::Line Drone::line() {
  return {.robot = *robot_,
          .id = robot_->id(),
          .journal = context_.journal,
          .session = context_.session,
          .by = journal::AppendedBy(generation_.load(), claim_.use()),
          .client = this};
}

// --- Its claim ---

void Drone::ClaimIfDue(SteadyTime now) {
  if (!claim_.IsDue(now, !waiting_.empty(), robot_->state.foreign())) return;
  claim_.Ask(now);
  context_.journal.Claim(
      *this, *robot_,
      {.robot = robot_->id(), .at = context_.clock.System(), .fleet_word = claim_.word()},
      claim_.gateway());
}

loop::StreamRef Drone::OnClaimed(const storage::ClaimResult& result) {
  // A stream here has its own word for the fleet.
  if (result.other_fleet && !robot_->HasStream()) {
    robot_->Disown(robot_->id()->fleet, *result.other_fleet);
  }
  std::vector<loop::StreamRef> wake;
  {
    const std::lock_guard lock(mutex_);
    claim_.Take(result);
    stored_.Set(result.samples);
    if (result.held_since == 0 && robot_->state.foreign()) live_.Clear();
    wake = std::exchange(unclaimed_, {});
  }
  for (const loop::StreamRef& caller : wake) caller.Wake();
  return {};
}

void Drone::NoteStoreReconnected() { static_cast<void>(OnFenced(context_.ledger)); }

loop::StreamRef Drone::OnSettled(std::span<const robot::Settled> settled,
                                 metrics::Ledger& /*ledger*/) {
  WaitingSamples::Settling settling;
  {
    const std::lock_guard lock(mutex_);
    settling = waiting_.Settle(settled);
  }
  return Tell(settling);
}

loop::StreamRef Drone::OnFenced(metrics::Ledger& /*ledger*/) {
  WaitingSamples::Settling settling;
  {
    const std::lock_guard lock(mutex_);
    generation_.fetch_add(1);
    claim_.Void();
    stored_.Set({});
    settling = waiting_.VoidAll();
  }
  return Tell(settling);
}

loop::StreamRef Drone::Tell(const WaitingSamples::Settling& settling) {
  robot_->calls.EndWaiting(settling.use);
  context_.ledger.Publish(settling.counts);
  for (const loop::StreamRef& caller : settling.wake) caller.Wake();
  return {};
}

}  // namespace uplink::uncrew
