#include "server/session/intake.h"

#include <utility>

#include "schema/rcan/judge.h"
#include "server/robot/mutation.h"
#include "server/session/expiry.h"
#include "server/session/frames.h"

namespace uplink::session {
namespace {

model::Rejection NoContent() {
  return {.reason = model::RejectReason::kUnsupportedContent,
          .field = "",
          .detail = "the uplink has no content"};
}

}  // namespace

Intake::Intake(const SessionContext& context, robot::Robot& robot, const model::SessionId& session,
               std::uint64_t generation)
    : context_(context),
      robot_(robot),
      id_(robot.id()),
      journal_(context.journals.Of(id_->ruri)),
      session_(session),
      generation_(generation),
      numbers_(robot.sessions, session) {}

void Intake::Begin(std::span<const UplinkView> uplinks, SteadyTime arrived,
                   SystemTime received_at) {
  batch_.Begin(uplinks);
  arrived_ = arrived;
  received_at_ = received_at;
}

HeldBack Intake::HeldBackBy(std::size_t outgoing) const {
  return session::HeldBackBy({.sessions = robot_.sessions,
                              .journal = journal_,
                              .throttle = throttle_,
                              .limits = context_.limits,
                              .clock = context_.clock},
                             outgoing);
}

Intake::Processed Intake::Process(std::size_t outgoing) {
  Processed processed;
  numbers_.Begin();
  while (pending() && !processed.is_void && !rejects_full() &&
         HeldBackBy(outgoing + processed.frames.size()) == HeldBack::kNone) {
    ProcessUplink(batch_.front(), processed);
    batch_.PopFront();
  }
  numbers_.Flush();
  if (std::exchange(sign_of_life_, false)) {
    robot_.state.SignOfLife(arrived_, received_at_, context_.fleet.presence_limits());
  }
  ApplyLive();
  Publish();
  if (!pending() || processed.is_void) Drop();
  return processed;
}

void Intake::ProcessUplink(const UplinkView& uplink, Processed& processed) {
  const robot::Seen seen = numbers_.See(uplink.seq);
  if (seen.as == robot::SeenAs::kVoid) {
    processed.is_void = true;
    return;
  }
  if (seen.as == robot::SeenAs::kDuplicate) return CountDuplicate(seen, processed);
  ++processed.messages;
  if (seen.missing_first > 0) AppendGap(seen);
  switch (uplink.content) {
    case UplinkView::Content::kRoverNexus:
      return JudgeRoverNexus(uplink, processed);
    case UplinkView::Content::kRcanRobotState:
      return JudgeRcan(uplink, processed);
    case UplinkView::Content::kNone:
      return Reject(uplink, NoContent(), metrics::kUnknownKind, processed);
  }
}

void Intake::CountDuplicate(const robot::Seen& seen, Processed& processed) {
  ++counts_.received;
  ++counts_.duplicate;
  if (robot::Planted(robot::Mutation::kDuplicateNotAcked)) return;
  ++processed.messages;
  if (!seen.waits) processed.ack_owed = true;
}

void Intake::AppendGap(const robot::Seen& seen) {
  counts_.missing += seen.missing_last - seen.missing_first + 1;
  robot_.sessions.AddGap();
  journal_.AppendGap(robot_, generation_,
                     {.robot = id_,
                      .session = session_,
                      .first = seen.missing_first,
                      .last = seen.missing_last,
                      .seen_at = received_at_});
}

void Intake::JudgeRoverNexus(const UplinkView& uplink, Processed& processed) {
  schema::Judgement judgement = context_.judge.Payload(std::as_bytes(std::span(uplink.payload)));
  sign_of_life_ = sign_of_life_ || judgement.sign_of_life;
  if (judgement.times_unknown > 0 || judgement.enumerants_unrecognized > 0) {
    context_.ledger.CountOdd(judgement.times_unknown, judgement.enumerants_unrecognized);
  }
  if (const model::Rejection* rejection = judgement.rejection()) {
    const std::size_t kind =
        judgement.variant ? static_cast<std::size_t>(*judgement.variant) : metrics::kUnknownKind;
    return Reject(uplink, *rejection, kind, processed);
  }
  Accept(uplink, std::get<model::Record>(judgement.verdict), processed);
}

void Intake::JudgeRcan(const UplinkView& uplink, Processed& processed) {
  schema::RcanJudgement judgement =
      schema::JudgeRcanState(uplink.payload, id_->ruri, context_.limits.message_bytes_max);
  sign_of_life_ = sign_of_life_ || (judgement.sign_of_life && context_.limits.rcan_counts_as_life);
  if (const model::Rejection* rejection = judgement.rejection()) {
    return Reject(uplink, *rejection, metrics::kRcanKind, processed);
  }
  if (rcan_order_ == nullptr) rcan_order_ = std::make_unique<RcanOrder>();
  auto& state = std::get<model::RcanState>(judgement.verdict);
  counts_.rcan_missing += rcan_order_->See(state);
  const RcanOrder::Age age = rcan_order_->AgeOf(state);
  if (age == RcanOrder::Age::kOlder) {
    return Reject(
        uplink,
        schema::NotMonotonic("timestamp_us", state.timestamp_us, rcan_order_->last_timestamp_us()),
        metrics::kRcanKind, processed);
  }
  ++counts_.rcan_states;
  TellDropped(uplink.seq, judgement.dropped, metrics::kRcanKind, processed);
  numbers_.AddSettled(uplink.seq);
  if (age == RcanOrder::Age::kSame) return CountSuperseded();
  rcan_order_->Apply(state);
  const FrameLive::Before before = context_.scratch.live.Add(std::move(state));
  if (before == FrameLive::Before::kReplaced) CountSuperseded();
}

void Intake::Accept(const UplinkView& uplink, model::Record& record, Processed& processed) {
  ++counts_.records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    TellDropped(uplink.seq, record.dropped(), static_cast<std::size_t>(record.variant()),
                processed);
    numbers_.AddSettled(uplink.seq);
    return AddLive(std::move(record));
  }
  if (ExpiredOnArrival(record.body(), received_at_, context_.clock_trust)) {
    numbers_.AddSettled(uplink.seq);
    return CountSuperseded();
  }
  robot_.state.KeepReport(record.body(), received_at_);
  Append(uplink.seq, std::move(record), std::string(uplink.payload), uplink.payload.size());
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
  robot_.state.CountDropped(dropped.size());
  for (const model::DroppedField& field : dropped) {
    context_.ledger.CountDropped(kind, field.reason);
    if (robot_.sessions.MayNotice(field.field, arrived_)) {
      context_.probe.notices_total.Add();
      processed.frames.push_back(NoticeFrame(seq, field));
    }
  }
}

void Intake::Reject(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
                    Processed& processed) {
  // Now, not the frame's arrival: a large frame may be processed over several seconds.
  throttle_.AddMalformed(context_.clock.Steady());
  context_.ledger.CountRejected(kind, rejection.reason);
  processed.frames.push_back(RejectFrame(uplink.seq, rejection));
  robot_.sessions.Remember(session_, uplink.seq, rejection);
  std::string kept;
  if (robot_.sessions.KeepPayload(rejection.reason, arrived_)) {
    kept = uplink.payload.substr(0, context_.limits.payload_bytes_max);
  }
  Append(uplink.seq, storage::QuarantineItem{.rejection = rejection}, std::move(kept),
         uplink.payload.size());
}

void Intake::Append(model::Seq seq, std::variant<model::Record, storage::QuarantineItem> content,
                    std::string payload, std::size_t payload_bytes) {
  ++counts_.received;
  const std::int64_t grew = numbers_.AddWaiting(seq);
  if (grew == 0) {
    ++counts_.superseded;  // another process took the robot since the number was seen
    return;
  }
  counts_.in_flight += grew;
  // Published before the writer can settle it, so that no scrape sees it settled and not received.
  Publish();
  journal_.Append(robot_, generation_,
                  {.robot = id_,
                   .session = session_,
                   .seq = seq,
                   .received_at = received_at_,
                   .content = std::move(content),
                   .payload = std::move(payload),
                   .payload_bytes = payload_bytes},
                  arrived_);
}

void Intake::ApplyLive() {
  const std::size_t applied = context_.scratch.live.Apply(robot_.state, arrived_, context_.judge);
  counts_.received += applied;
  counts_.applied += applied;
}

void Intake::Publish() {
  context_.ledger.Publish(counts_);
  counts_ = {};
}

}  // namespace uplink::session
