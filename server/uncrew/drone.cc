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

Drone::Drone(const Context& context, fleet::RobotPtr robot)
    : context_(context), robot_(std::move(robot)), waiting_(robot_->calls) {
  share_.CountIn(context_.live_total);
  robot_->calls.Begin(this);
}

Drone::~Drone() { robot_->calls.End(this); }

bool Drone::SetSpeaker(const fleet::Claim& claim, const fleet::Entry& entry, bool moved) {
  const auto now = robot_->id();
  const bool same = now->fleet == claim.robot.fleet;
  if (!same && !entry.Moves(claim, now->fleet)) return false;
  const std::lock_guard lock(mutex_);
  // The store had it in the fleet of another caller.
  if (same && claim_.is_other_fleet()) claim_.TellFleet(waiting_.empty());
  if (moved || !same) claim_.Move();
  const bool is_new = claim_.SpeakAs(claim, entry.Moves(claim), context_.journal);
  if (is_new && !robot_->HasStream()) robot_->SetSpeaker(claim.gateway);
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

Drone::Offered Drone::Offer(ingest::Port& port, const Sample& sample, loop::StreamRef caller) {
  Offered offered;
  {
    const std::lock_guard lock(mutex_);
    offered = Take(port, sample, caller);
    share_.Set(live_.bytes() + stored_.bytes());
  }
  // Past the budget, this drone may lose its live samples.
  context_.live_total->Check();
  return offered;
}

Drone::Offered Drone::Take(ingest::Port& port, const Sample& sample, loop::StreamRef caller) {
  // Since the call began.
  if (robot_->blocked()) {
    static_cast<void>(Settle(port, sample, metrics::Became::kBlocked));
    return {.is = Offered::Is::kBlocked};
  }
  if (robot_->kept_out()) {
    static_cast<void>(Settle(port, sample, metrics::Became::kBlocked));
    return {.is = Offered::Is::kNotRegistered};
  }
  // An operator wants to forget it. The sample comes again, to a new Drone.
  if (robot_->calls.asked_to_end(context_.clock.Steady()))
    return Settle(port, sample, metrics::Became::kRefused);
  ClaimIfDue(context_.clock.Steady());
  if (claim_.is_other_fleet()) {
    static_cast<void>(Settle(port, sample, metrics::Became::kRefused));
    return {.is = Offered::Is::kOtherFleet};
  }
  const bool is_foreign = robot_->state.foreign();
  if (sample.judged.decoded && !is_foreign) {
    port.NoteLife(line(), sample.arrived, sample.arrived_system);
  }
  if (sample.is_rejected()) return OfferDurable(port, sample, caller);
  // Sets are shown at once, even while the store is away.
  if (IsSet(sample.judged.type) && !is_foreign && !live_.IsOlder(sample.live())) {
    live_.Apply(sample.live());
  }
  if (sample.row().kind == SampleKind::kLive) return OfferLive(port, sample);
  return OfferDurable(port, sample, caller);
}

Drone::Offered Drone::OfferLive(ingest::Port& port, const Sample& sample) {
  // Another server has it, and shows its live samples.
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
  if (offered.answer == ingest::Port::Answer::kLimited) return {.answer = message.LimitedAnswer()};
  if (!is_old) live_.Apply(live);
  return {.answer = {.outcome = is_old ? Outcome::kSuperseded : Outcome::kApplied}};
}

Drone::Offered Drone::OfferDurable(ingest::Port& port, const Sample& sample,
                                   loop::StreamRef caller) {
  if (!claim_.serves()) return AwaitClaim(caller);
  const storage::SampleRef mark = sample.MarkUnder(claim_.epoch());
  const Answer if_known{.outcome = sample.is_rejected() ? Outcome::kRejected : Outcome::kDuplicate};
  if (const TicketRef ticket = waiting_.Find(mark->type, &mark->digest)) {
    static_cast<void>(Settle(port, sample, metrics::Became::kDuplicate));
    if (sample.is_bad_live()) return {.answer = if_known};
    return Wait(ticket, if_known, caller);
  }
  if (stored_.IsDuplicate(*mark)) {
    // It was shown above, but the store has a later one of its type.
    if (IsSet(sample.judged.type) && stored_.IsPast(*mark)) live_.Forget(sample.judged.type);
    static_cast<void>(Settle(port, sample, metrics::Became::kDuplicate));
    if (sample.is_bad_live()) return {.answer = if_known};
    return AskStore(if_known, caller);
  }
  if (sample.is_ordered() && live_.IsOlder(sample.live())) {
    return Settle(port, sample, metrics::Became::kSuperseded);
  }
  return OfferRecords(port, sample, mark, caller);
}

Drone::Offered Drone::OfferRecords(ingest::Port& port, const Sample& sample,
                                   const storage::SampleRef& mark, loop::StreamRef caller) {
  std::vector<storage::CommitRecord> records;
  if (!sample.is_rejected()) {
    const SampleType type = sample.judged.type;
    const auto before = Recall(type, stored_.Last(type));
    if (before && sample.is_ordered() && IsOlder(sample.judged.metadata, before->metadata)) {
      if (IsSet(type) && live_.IsHeld(sample.live())) live_.Forget(type);
      return AskStore(Settle(port, sample, metrics::Became::kSuperseded).answer, caller);
    }
    records = sample.RecordsOf(Records::Of(sample.judged, before ? &before->value : nullptr));
    if (records.empty()) return SettleUnchanged(port, sample, caller);
  }
  DroneMessage message({.judged = sample.judged,
                        .arrival = sample.arrival(),
                        .mark = mark,
                        .records = std::move(records),
                        .rate = sample.is_bad_live() ? &rate_ : nullptr,
                        .now = context_.clock.Steady(),
                        .waiting = waiting_,
                        .ledger = context_.ledger});
  const ingest::Port::Offered offered = port.Offer(line(), message);
  port.Publish();
  if (offered.answer == ingest::Port::Answer::kWaits) return {.is = Offered::Is::kNoRoom};
  if (message.limited()) return {.answer = message.LimitedAnswer()};
  if (message.ticket() == nullptr) return {.answer = {.outcome = Outcome::kUnavailable}};
  stored_.Add(*mark);
  if (!sample.is_rejected() && !robot_->state.foreign()) live_.Apply(sample.live());
  if (sample.is_bad_live()) return {.answer = {.outcome = Outcome::kRejected}};
  return Wait(message.ticket(),
              {.outcome = sample.is_rejected() ? Outcome::kRejected : Outcome::kStored}, caller);
}

Drone::Offered Drone::SettleUnchanged(ingest::Port& port, const Sample& sample,
                                      loop::StreamRef caller) {
  if (sample.row().kind == SampleKind::kDurableOnChange) {
    Offered live = OfferLive(port, sample);
    if (live.answer.outcome == Outcome::kRejected) return live;
    // Ask even if another server has the live state: its value may have changed since.
    return AskStore(std::move(live.answer), caller);
  }
  Offered same = Settle(port, sample, metrics::Became::kSuperseded);
  // A drone may rely on the answer: the set is known once it is committed.
  const TicketRef ticket = waiting_.Find(NumberOf(sample.judged.type), nullptr);
  return ticket == nullptr ? AskStore(same.answer, caller) : Wait(ticket, same.answer, caller);
}

Drone::Offered Drone::AskStore(Answer answer, loop::StreamRef caller) {
  Offered waits = Wait(waiting_.Ask(), std::move(answer), caller);
  AppendQuestionIfDue();
  return waits;
}

void Drone::AppendQuestionIfDue() {
  if (!waiting_.HasDueQuestion()) return;
  std::vector<storage::CommitRecord> question;
  question.push_back(QuestionOf({.robot = robot_->id(),
                                 .session = context_.session,
                                 .received_at = context_.clock.System(),
                                 .claim = claim_.epoch()}));
  waiting_.AddQuestion(question);
  context_.journal.AppendMessage(*this, line().by, std::move(question), context_.clock.Steady());
}

ingest::Line Drone::line() {
  return {.robot = *robot_,
          .id = robot_->id(),
          .journal = context_.journal,
          .session = context_.session,
          .by = journal::AppendedBy(generation_.load(), claim_.use()),
          .client = this};
}

void Drone::ClaimIfDue(SteadyTime now) {
  if (!claim_.IsDue(now, !waiting_.empty(), robot_->state.foreign())) return;
  claim_.Ask(now);
  context_.journal.Claim(
      *this, *robot_,
      {.robot = robot_->id(), .at = context_.clock.System(), .fleet_word = claim_.word()},
      claim_.gateway());
}

loop::StreamRef Drone::OnClaimed(const storage::ClaimResult& result) {
  // A stream here makes its own claim about the fleet.
  if (result.other_fleet && !robot_->HasStream()) {
    robot_->Disown(robot_->id()->fleet, *result.other_fleet);
  }
  std::vector<loop::StreamRef> wake;
  {
    const std::lock_guard lock(mutex_);
    claim_.Take(result);
    stored_.Set(result.samples);
    if (result.held_since == 0 && robot_->state.foreign()) live_.Clear();
    share_.Set(live_.bytes() + stored_.bytes());
    wake = std::exchange(unclaimed_, {});
  }
  for (const loop::StreamRef& caller : wake) caller.Wake();
  return {};
}

std::size_t Drone::DropLive() {
  const std::lock_guard lock(mutex_);
  const std::size_t held = live_.bytes();
  live_.Clear();
  share_.Set(stored_.bytes());
  return held;
}

loop::StreamRef Drone::OnDoubted() {
  WaitingSamples::Settling settling;
  {
    const std::lock_guard lock(mutex_);
    claim_.Doubt();
    settling.wake = waiting_.VoidQuestions();
  }
  return Tell(settling);
}

loop::StreamRef Drone::OnSettled(std::span<const robot::Settled> settled,
                                 metrics::Ledger& /*ledger*/) {
  WaitingSamples::Settling settling;
  {
    const std::lock_guard lock(mutex_);
    settling = waiting_.Settle(settled);
    AppendQuestionIfDue();
    // Calls that wait for a claim may make it now.
    if (claim_.is_doubtful() && waiting_.empty()) {
      std::ranges::copy(std::exchange(unclaimed_, {}), std::back_inserter(settling.wake));
    }
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
    // Calls that waited until they may claim do so now.
    std::ranges::copy(std::exchange(unclaimed_, {}), std::back_inserter(settling.wake));
  }
  return Tell(settling);
}

loop::StreamRef Drone::Tell(const WaitingSamples::Settling& settling) {
  context_.ledger.Publish(settling.counts);
  for (const loop::StreamRef& caller : settling.wake) caller.Wake();
  return {};
}

}  // namespace uplink::uncrew
