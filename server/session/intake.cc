#include "server/session/intake.h"

#include <string>
#include <utility>
#include <variant>

#include "schema/rcan/judge.h"
#include "server/robot/mutation.h"
#include "server/session/frames.h"

namespace uplink::session {
Intake::Intake(const Sources& sources)
    : context_(sources.context),
      robot_(sources.robot),
      timers_(sources.timers),
      id_(robot_.id()),
      journal_(context_.journals.Of(id_->ruri)),
      session_(sources.session),
      gateway_(sources.by.gateway),
      numbers_(robot_.sessions, session_),
      appending_({.context = context_,
                  .robot = robot_,
                  .numbers = numbers_,
                  .counts = counts_,
                  .session = session_,
                  .by = sources.by}),
      live_({.context = context_, .robot = robot_, .counts = counts_, .session = session_}),
      allowance_(context_.allowances.Get()) {}

void Intake::Begin(std::span<const UplinkView> uplinks, SteadyTime arrived,
                   SystemTime received_at) {
  batch_.Begin(uplinks);
  arrived_ = arrived;
  received_at_ = received_at;
  appending_.Begin(arrived, received_at);
  live_.Begin(arrived, received_at);
}

HeldBackSources Intake::HoldSources() const {
  return {.robot = robot_,
          .journal = journal_,
          .gateway = gateway_.get(),
          .limits = context_.limits,
          .flow = allowance_->flow,
          .clock = context_.clock};
}

Hold Intake::HoldNow(std::size_t outgoing) {
  // Also while a message waits: a reload may be what lets it go on.
  if (allowance_version_ != context_.allowances.version()) {
    allowance_version_ = context_.allowances.version();
    allowance_ = context_.allowances.Get();
  }
  const Hold hold = HoldOfAll(HoldSources(), outgoing);
  return hold.none() && front_cost_ ? HoldOfRecord(HoldSources(), *front_cost_) : hold;
}

bool Intake::MayDecodeSurplus() const {
  const std::optional<SteadyTime> at = live_.DecodesAt(allowance_->telemetry);
  return at && *at <= context_.clock.Steady();
}

Intake::Processed Intake::Process(std::size_t outgoing) {
  Processed processed;
  numbers_.Begin();
  costly_ = 0;
  if (MayDecodeSurplus()) live_.Decode(allowance_->telemetry, processed);
  while (pending() && !processed.is_void && !rejects_full() && !yields() &&
         HoldNow(outgoing + processed.frames.size()).none()) {
    if (!ProcessUplink(batch_.front(), processed)) break;
    costly_ = processed.costly;
    front_cost_.reset();
    batch_.PopFront();
  }
  appending_.Flush();
  numbers_.Flush();
  live_.Apply();
  appending_.Publish();
  if (const auto at = live_.DecodesAt(allowance_->telemetry)) {
    timers_.Set(Timer::kSurplus, *at);
  } else {
    timers_.Clear(Timer::kSurplus);
  }
  // The batch's own bytes may go now.
  live_.Keep();
  if (!pending() || processed.is_void) Drop();
  return processed;
}

void Intake::End() {
  if (!live_.DecodesAt(allowance_->telemetry)) return;
  Processed untold;
  live_.Decode(allowance_->telemetry, untold);
  live_.Apply();
  appending_.Publish();
}

bool Intake::ProcessUplink(const UplinkView& uplink, Processed& processed) {
  const robot::Seen seen = numbers_.See(uplink.seq);
  if (seen.as == robot::SeenAs::kVoid) {
    processed.is_void = true;
    return true;
  }
  if (seen.as == robot::SeenAs::kDuplicate) {
    CountDuplicate(seen, processed);
    return true;
  }
  if (const auto kind = live_.OverRate(uplink, allowance_->telemetry)) {
    if (!HasRoom(CostOfGap(seen))) return false;
    AddGap(seen);
    live_.AddUndecoded(*kind, uplink);
    numbers_.AddSettled(uplink.seq);
  } else {
    Judged judged = JudgeUplink(context_, id_->ruri, uplink, received_at_);
    if (!HasRoom(CostOf(uplink, seen, judged))) return false;
    AddGap(seen);
    Accept(uplink, judged, processed);
  }
  ++processed.messages;
  return true;
}

bool Intake::HasRoom(const RecordCost& cost) {
  if (cost.journal_bytes == 0 || HoldOfRecord(HoldSources(), cost).none()) return true;
  front_cost_ = cost;
  numbers_.PutBack();
  return false;
}

void Intake::AddGap(const robot::Seen& seen) {
  if (seen.missing_first == 0) return;
  if (IsNew(seen.missing_last)) TakeFlow(0);
  appending_.AddGap(seen);
}

void Intake::CountDuplicate(const robot::Seen& seen, Processed& processed) {
  ++counts_.received;
  ++counts_.duplicate;
  if (robot::Planted(robot::Mutation::kDuplicateNotAcked)) return;
  ++processed.messages;
  if (!seen.waits) processed.ack_owed = true;
}

RecordCost Intake::CostOfGap(const robot::Seen& seen) const {
  RecordCost cost;
  if (seen.missing_first == 0) return cost;
  cost.journal_bytes = robot::kRecordOverheadBytes;
  if (IsNew(seen.missing_last)) cost.flow_bytes = 0;
  return cost;
}

RecordCost Intake::CostOf(const UplinkView& uplink, const robot::Seen& seen,
                          const Judged& judged) const {
  const std::size_t payload = uplink.payload.size();
  RecordCost cost = CostOfGap(seen);
  if (const auto* record = std::get_if<model::Record>(&judged.content)) {
    const bool durable = record->durable() && !judged.expired;
    if (durable && IsNew(uplink.seq) &&
        robot_.rates.WouldLimit(record->body(), allowance_->rates, context_.clock.Steady())) {
      // As a gap; a number that goes on with a range takes no flow, and is in flight like any
      // other.
      cost.journal_bytes += robot::kRecordOverheadBytes;
      if (!appending_.Continues(uplink.seq)) cost.flow_bytes = 0;
    } else if (durable) {
      cost.journal_bytes += journal::CostOf(payload, *record);
      if (IsNew(uplink.seq)) cost.flow_bytes = FlowBytes(payload, *record);
    }
  } else if (const auto* rejection = std::get_if<model::Rejection>(&judged.content)) {
    cost.journal_bytes += journal::CostOf(payload, *rejection);
  } else if (live_.AgeOf(std::get<model::RcanState>(judged.content)) == RcanOrder::Age::kOlder) {
    cost.journal_bytes += journal::CostOf(payload, model::Rejection());
  }
  return cost;
}

void Intake::Accept(const UplinkView& uplink, Judged& judged, Processed& processed) {
  live_.TakeRate(judged.kind, allowance_->telemetry);
  if (judged.sign_of_life) live_.NoteLife();
  if (judged.odd.any()) context_.ledger.CountOdd(judged.odd);
  if (const auto* rejection = std::get_if<model::Rejection>(&judged.content)) {
    return Reject(uplink, *rejection, judged.kind, processed);
  }
  if (auto* record = std::get_if<model::Record>(&judged.content)) {
    return AcceptRecord(uplink, *record, judged.expired, processed);
  }
  AcceptState(uplink, judged, processed);
}

void Intake::AcceptState(const UplinkView& uplink, Judged& judged, Processed& processed) {
  const auto& state = std::get<model::RcanState>(judged.content);
  const RcanOrder::Age age = live_.See(state);
  if (age == RcanOrder::Age::kOlder) {
    return Reject(
        uplink, schema::NotMonotonic("timestamp_us", state.timestamp_us, live_.last_timestamp_us()),
        metrics::kRcanKind, processed);
  }
  numbers_.AddSettled(uplink.seq);
  live_.Add(uplink.seq, std::move(judged), age, processed);
}

void Intake::AcceptRecord(const UplinkView& uplink, model::Record& record, bool expired,
                          Processed& processed) {
  // An upsert that had expired is superseded, whatever its rate.
  if (!expired && Limit(uplink, record, processed)) {
    return context_.judge.Reuse(std::move(record));
  }
  ++counts_.records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    numbers_.AddSettled(uplink.seq);
    return live_.Add(uplink.seq, std::move(record), processed);
  }
  if (expired) {
    numbers_.AddSettled(uplink.seq);
    return live_.CountSuperseded();
  }
  if (IsNew(uplink.seq)) TakeFlow(FlowBytes(uplink.payload.size(), record));
  robot_.state.KeepReport(record.body(), received_at_);
  const std::optional<storage::LatestKind> latest = storage::LatestKindOf(record.variant());
  appending_.Add(uplink.seq, std::move(record), std::string(uplink.payload), uplink.payload.size());
  // After it waits, so that an answer of the store that comes now takes it into account.
  if (latest) robot_.sessions.AddLatest(session_, uplink.seq, *latest);
}

bool Intake::Limit(const UplinkView& uplink, const model::Record& record, Processed& processed) {
  const std::size_t variant = static_cast<std::size_t>(record.variant());
  if (allowance_->rates[variant].rate == 0) return false;
  if (!IsNew(uplink.seq)) return false;
  const std::optional<milliseconds> again =
      robot_.rates.Limit(record.body(), allowance_->rates, context_.clock.Steady());
  if (!again) return false;
  ++processed.costly;
  robot_.limited_throttle.Add(context_.clock.Steady());
  robot::RejectedSeq limited{.seq = uplink.seq,
                             .rejection = robot::RateLimited(allowance_->rates[variant]),
                             .retry_after_ms = again->count()};
  context_.ledger.CountRejected(variant, model::RejectReason::kRateLimited);
  processed.frames.push_back(RejectFrame(limited.seq, limited.rejection, limited.retry_after_ms));
  if (record.durable() && !robot::Planted(robot::Mutation::kLimitedNotStored)) {
    if (!appending_.Continues(limited.seq)) TakeFlow(0);
    appending_.AddLimited(std::move(limited));
  } else {
    ++counts_.received;
    robot_.sessions.RememberLive(session_, std::move(limited));
    numbers_.AddSettled(uplink.seq);
    ++counts_.rejected;
    ++counts_.rejects[static_cast<std::size_t>(model::RejectReason::kRateLimited)];
  }
  return true;
}

void Intake::Reject(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
                    Processed& processed) {
  // Now, not the frame's arrival: a large frame may be processed over several seconds.
  robot_.throttle.Add(context_.clock.Steady());
  ++processed.costly;
  context_.ledger.CountRejected(kind, rejection.reason);
  processed.frames.push_back(RejectFrame(uplink.seq, rejection));
  robot_.sessions.Remember(session_, {.seq = uplink.seq, .rejection = rejection});
  std::string kept;
  if (!robot_.flow.disk_limits() && robot_.sessions.KeepPayload(rejection.reason, arrived_)) {
    kept = uplink.payload.substr(0, context_.limits.payload_bytes_max);
    robot_.flow.CountKept(kept.size());
  }
  appending_.Add(uplink.seq, storage::QuarantineItem{.rejection = rejection}, std::move(kept),
                 uplink.payload.size());
}

}  // namespace uplink::session
