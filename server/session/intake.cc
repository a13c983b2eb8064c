#include "server/session/intake.h"

#include <utility>

#include "schema/rcan/judge.h"
#include "server/robot/mutation.h"
#include "server/session/frames.h"

namespace uplink::session {
Intake::Intake(const SessionContext& context, robot::Robot& robot, const model::SessionId& session,
               std::uint64_t generation)
    : context_(context),
      robot_(robot),
      id_(robot.id()),
      journal_(context.journals.Of(id_->ruri)),
      session_(session),
      numbers_(robot.sessions, session),
      appending_({.context = context,
                  .robot = robot,
                  .numbers = numbers_,
                  .counts = counts_,
                  .session = session,
                  .generation = generation}),
      allowance_(context.allowances.Get()) {}

void Intake::Begin(std::span<const UplinkView> uplinks, SteadyTime arrived,
                   SystemTime received_at) {
  batch_.Begin(uplinks);
  arrived_ = arrived;
  received_at_ = received_at;
  appending_.Begin(arrived, received_at);
}

HeldBackSources Intake::Sources() const {
  return {.robot = robot_,
          .journal = journal_,
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
  const Hold hold = HoldOfAll(Sources(), outgoing);
  return hold.none() && front_cost_ ? HoldOfRecord(Sources(), *front_cost_) : hold;
}

Intake::Processed Intake::Process(std::size_t outgoing) {
  Processed processed;
  numbers_.Begin();
  costly_ = 0;
  while (pending() && !processed.is_void && !rejects_full() && !yields() &&
         HoldNow(outgoing + processed.frames.size()).none()) {
    if (!ProcessUplink(batch_.front(), processed)) break;
    front_cost_.reset();
    batch_.PopFront();
  }
  appending_.Flush();
  numbers_.Flush();
  if (std::exchange(sign_of_life_, false)) {
    robot_.state.SignOfLife(arrived_, received_at_, context_.fleet.presence_limits_of(robot_));
  }
  ApplyLive();
  appending_.Publish();
  if (!pending() || processed.is_void) Drop();
  return processed;
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
  Judged judged = JudgeUplink(context_, id_->ruri, uplink, received_at_);
  if (const std::optional<RecordCost> cost = CostOf(uplink, seen, judged)) {
    const Hold hold = HoldOfRecord(Sources(), *cost);
    if (!hold.none()) {
      front_cost_ = cost;
      numbers_.PutBack();
      return false;
    }
  }
  ++processed.messages;
  if (seen.missing_first > 0) {
    if (IsNew(seen.missing_last)) TakeFlow(0);
    appending_.AddGap(seen);
  }
  Accept(uplink, judged, processed);
  return true;
}

void Intake::CountDuplicate(const robot::Seen& seen, Processed& processed) {
  ++counts_.received;
  ++counts_.duplicate;
  if (robot::Planted(robot::Mutation::kDuplicateNotAcked)) return;
  ++processed.messages;
  if (!seen.waits) processed.ack_owed = true;
}

std::optional<RecordCost> Intake::CostOf(const UplinkView& uplink, const robot::Seen& seen,
                                         const Judged& judged) const {
  const std::size_t payload = uplink.payload.size();
  RecordCost cost;
  if (seen.missing_first > 0) {
    cost.journal_bytes = robot::kRecordOverheadBytes;
    if (IsNew(seen.missing_last)) cost.flow_bytes = 0;
  }
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
  } else if (AgeOf(std::get<model::RcanState>(judged.content)) == RcanOrder::Age::kOlder) {
    cost.journal_bytes += journal::CostOf(payload, model::Rejection());
  }
  return cost.journal_bytes > 0 ? std::optional(cost) : std::nullopt;
}

void Intake::Accept(const UplinkView& uplink, Judged& judged, Processed& processed) {
  sign_of_life_ = sign_of_life_ || judged.sign_of_life;
  if (judged.odd.any()) context_.ledger.CountOdd(judged.odd);
  if (const auto* rejection = std::get_if<model::Rejection>(&judged.content)) {
    return Reject(uplink, *rejection, judged.kind, processed);
  }
  if (auto* record = std::get_if<model::Record>(&judged.content)) {
    return AcceptRecord(uplink, *record, judged.expired, processed);
  }
  AcceptState(uplink, judged, processed);
}

RcanOrder::Age Intake::AgeOf(const model::RcanState& state) const {
  return rcan_order_ == nullptr ? RcanOrder::Age::kNewer : rcan_order_->AgeOf(state);
}

void Intake::AcceptState(const UplinkView& uplink, Judged& judged, Processed& processed) {
  auto& state = std::get<model::RcanState>(judged.content);
  const RcanOrder::Age age = AgeOf(state);
  if (rcan_order_ == nullptr) rcan_order_ = std::make_unique<RcanOrder>();
  counts_.rcan_missing += rcan_order_->See(state);
  if (age == RcanOrder::Age::kOlder) {
    return Reject(
        uplink,
        schema::NotMonotonic("timestamp_us", state.timestamp_us, rcan_order_->last_timestamp_us()),
        metrics::kRcanKind, processed);
  }
  ++counts_.rcan_states;
  TellDropped(uplink.seq, judged.dropped, metrics::kRcanKind, processed);
  CountUntold(judged.untold, metrics::kRcanKind);
  numbers_.AddSettled(uplink.seq);
  if (age == RcanOrder::Age::kSame) return CountSuperseded();
  rcan_order_->Apply(state);
  const FrameLive::Before before = context_.scratch.live.Add(std::move(state));
  if (before == FrameLive::Before::kReplaced) CountSuperseded();
}

void Intake::AcceptRecord(const UplinkView& uplink, model::Record& record, bool expired,
                          Processed& processed) {
  // An upsert that had expired is superseded, whatever its rate.
  if (!expired && Limit(uplink, record, processed)) {
    return context_.judge.Reuse(std::move(record));
  }
  ++counts_.records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    const auto kind = static_cast<std::size_t>(record.variant());
    TellDropped(uplink.seq, record.dropped(), kind, processed);
    CountUntold(record.untold(), kind);
    numbers_.AddSettled(uplink.seq);
    return AddLive(std::move(record));
  }
  if (expired) {
    numbers_.AddSettled(uplink.seq);
    return CountSuperseded();
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
  ++costly_;
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

void Intake::AddLive(model::Record record) {
  if (std::optional<model::Record> replaced = context_.scratch.live.Add(std::move(record))) {
    CountSuperseded();
    context_.judge.Reuse(*std::move(replaced));
  }
}

void Intake::CountSuperseded() {
  ++counts_.received;
  ++counts_.superseded;
}

void Intake::TellDropped(model::Seq seq, std::span<const model::DroppedField> dropped,
                         std::size_t kind, Processed& processed) {
  if (dropped.empty()) return;
  ++costly_;
  robot_.state.CountDropped(dropped.size());
  for (const model::DroppedField& field : dropped) {
    context_.ledger.CountDropped(kind, field.reason);
    if (robot_.sessions.MayNotice(field.field, arrived_)) {
      context_.probe.notices_total.Add();
      processed.frames.push_back(NoticeFrame(seq, field));
    }
  }
}

void Intake::CountUntold(std::span<const model::UntoldFields> untold, std::size_t kind) {
  for (const model::UntoldFields& fields : untold) {
    robot_.state.CountDropped(fields.fields);
    context_.ledger.CountDropped(kind, fields.reason, fields.fields);
  }
}

void Intake::Reject(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
                    Processed& processed) {
  // Now, not the frame's arrival: a large frame may be processed over several seconds.
  robot_.throttle.Add(context_.clock.Steady());
  ++costly_;
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

void Intake::ApplyLive() {
  const std::size_t applied = context_.scratch.live.Apply(robot_.state, arrived_, context_.judge);
  counts_.received += applied;
  counts_.applied += applied;
}

}  // namespace uplink::session
