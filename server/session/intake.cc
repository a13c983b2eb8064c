#include "server/session/intake.h"

#include <algorithm>
#include <span>
#include <utility>

#include "server/robot/mutation.h"
#include "server/session/frames.h"

namespace uplink::session {
namespace {

/// A later live message of the same frame replaces these kinds whole.
bool ReplacedWhole(model::Variant variant) {
  const std::optional<storage::LivePart> part = robot::PartOfVariant(variant);
  return part && storage::RowOf(*part).keys_max == 1;
}

/// An upsert whose expiry has passed on arrival is neither stored nor forwarded.
bool ExpiredOnArrival(const model::Body& body, SystemTime now) {
  const auto passed = [now](std::int64_t expiry_ms) {
    return expiry_ms != 0 && expiry_ms <= UnixMs(now);
  };
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    return shape->upsert() != nullptr && passed(shape->upsert()->expire_time_ms);
  }
  if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    return object->upsert() != nullptr && passed(object->upsert()->expires_unix_time_ms);
  }
  return false;
}

model::Rejection NoContent() {
  return {.reason = model::RejectReason::kUnsupportedContent,
          .field = "",
          .detail = "the uplink has no content"};
}

}  // namespace

Intake::Intake(const SessionContext& context, robot::Robot& robot, storage::RobotRef id,
               const model::SessionId& session, std::uint64_t generation)
    : context_(context),
      journal_(context.journals.Of(id->ruri)),
      robot_(robot),
      id_(std::move(id)),
      session_(session),
      generation_(generation) {}

void Intake::Begin(std::span<const UplinkView> uplinks, SteadyTime arrived,
                   SystemTime received_at) {
  uplinks_ = uplinks;
  arrived_ = arrived;
  received_at_ = received_at;
}

void Intake::Keep() {
  if (!pending() || kept_ != nullptr) return;
  auto kept = std::make_unique<Kept>();
  kept->uplinks.assign(uplinks_.begin(), uplinks_.end());
  std::size_t bytes = 0;
  for (const UplinkView& uplink : uplinks_) bytes += uplink.payload.size();
  kept->bytes.reserve(bytes);
  // There is room for all, so appending moves no byte.
  for (UplinkView& uplink : kept->uplinks) {
    kept->bytes.append(uplink.payload);
    uplink.payload =
        std::string_view(kept->bytes).substr(kept->bytes.size() - uplink.payload.size());
  }
  uplinks_ = kept->uplinks;
  kept_ = std::move(kept);
}

void Intake::Drop() {
  uplinks_ = {};
  kept_.reset();
}

Hold Intake::Holding(std::size_t outgoing) const {
  if (robot_.sessions.in_flight() >= context_.limits.in_flight_uplinks_max) return Hold::kInFlight;
  if (!journal_.HasRoom()) return Hold::kJournal;
  if (outgoing >= kOutgoingFramesMax) return Hold::kOutgoing;
  const std::optional<SteadyTime> throttled = throttle_end();
  if (throttled && context_.clock.Steady() < *throttled) return Hold::kThrottled;
  return Hold::kNone;
}

std::optional<SteadyTime> Intake::throttle_end() const {
  if (malformed_ <= kMalformedPerSecondMax) return std::nullopt;
  return malformed_since_ + std::chrono::seconds(1);
}

Intake::Taken Intake::Take(std::size_t outgoing) {
  Taken taken;
  new_before_ = 0;
  while (pending() && !taken.is_void && Holding(outgoing + taken.frames.size()) == Hold::kNone) {
    TakeOne(uplinks_.front(), taken);
    uplinks_ = uplinks_.subspan(1);
  }
  SettleRun();
  if (std::exchange(sign_of_life_, false)) {
    robot_.state.SignOfLife(arrived_, received_at_, context_.fleet.presence_limits());
  }
  ApplyLive();
  Publish();
  if (!pending() || taken.is_void) Drop();
  return taken;
}

robot::Seen Intake::See(model::Seq seq) {
  // Numbers of a batch increase, so what follows a new one is new, and where it follows at once
  // nothing is missing: no look is needed.
  if (new_before_ > 0 && seq == new_before_ + 1) return {};
  SettleRun();
  return robot_.sessions.See(session_, seq);
}

void Intake::SettleRun() {
  if (unsettled_ == 0) return;
  robot_.sessions.AddSettled(session_, std::exchange(unsettled_, 0));
}

void Intake::TakeDuplicate(const robot::Seen& seen, Taken& taken) {
  ++counts_.received;
  ++counts_.duplicate;
  if (robot::Planted(robot::Mutation::kDuplicateNotAcked)) return;
  ++taken.messages;
  if (!seen.waits) taken.ack_owed = true;
}

void Intake::TakeOne(const UplinkView& uplink, Taken& taken) {
  const robot::Seen seen = See(uplink.seq);
  new_before_ = 0;
  if (seen.place == robot::Place::kVoid) {
    taken.is_void = true;
    return;
  }
  if (seen.place == robot::Place::kDuplicate) return TakeDuplicate(seen, taken);
  new_before_ = uplink.seq;
  ++taken.messages;
  if (seen.missing_first > 0) NoteMissing(seen);
  switch (uplink.content) {
    case UplinkView::Content::kRoverNexus:
      return TakeRoverNexus(uplink, taken);
    case UplinkView::Content::kRcanRobotState:
      return TakeRcan(uplink, taken);
    case UplinkView::Content::kNone:
      return TakeRejected(uplink, NoContent(), metrics::kUnknownKind, taken);
  }
}

void Intake::TakeRoverNexus(const UplinkView& uplink, Taken& taken) {
  schema::Judgement judgement = context_.judge.Payload(std::as_bytes(std::span(uplink.payload)));
  sign_of_life_ = sign_of_life_ || judgement.sign_of_life;
  if (judgement.times_unknown > 0 || judgement.enumerants_unrecognized > 0) {
    context_.ledger.CountOdd(judgement.times_unknown, judgement.enumerants_unrecognized);
  }
  if (const model::Rejection* rejection = judgement.rejection()) {
    const std::size_t kind =
        judgement.variant ? static_cast<std::size_t>(*judgement.variant) : metrics::kUnknownKind;
    TakeRejected(uplink, *rejection, kind, taken);
  } else {
    TakeRecord(uplink, judgement, taken);
  }
}

void Intake::NoteMissing(const robot::Seen& seen) {
  counts_.missing += seen.missing_last - seen.missing_first + 1;
  robot_.sessions.AddGap();
  journal_.AppendGap(robot_.sessions, generation_,
                     {.robot = id_,
                      .session = session_,
                      .first = seen.missing_first,
                      .last = seen.missing_last,
                      .seen_at = received_at_});
}

void Intake::TakeRecord(const UplinkView& uplink, schema::Judgement& judgement, Taken& taken) {
  auto& record = std::get<model::Record>(judgement.verdict);
  ++counts_.records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    NoteDropped(uplink.seq, record.dropped(), static_cast<std::size_t>(record.variant()), taken);
    unsettled_ = uplink.seq;
    return TakeLive(std::move(record));
  }
  if (ExpiredOnArrival(record.body(), received_at_)) {
    unsettled_ = uplink.seq;
    ++counts_.received;
    ++counts_.superseded;
    return;
  }
  robot_.state.Note(record.body(), received_at_);
  Append(uplink.seq, std::move(record), std::string(uplink.payload), uplink.payload.size());
}

void Intake::TakeLive(model::Record record) {
  std::vector<model::Record>& live = context_.scratch.live;
  if (ReplacedWhole(record.variant())) {
    const auto before = std::ranges::find(live, record.variant(), &model::Record::variant);
    if (before != live.end()) {
      ++counts_.received;
      ++counts_.superseded;
      std::swap(*before, record);
      return context_.judge.Reuse(std::move(record));
    }
  }
  live.push_back(std::move(record));
}

void Intake::NoteDropped(model::Seq seq, std::span<const model::DroppedField> dropped,
                         std::size_t kind, Taken& taken) {
  if (dropped.empty()) return;
  robot_.state.CountDropped(dropped.size());
  for (const model::DroppedField& field : dropped) {
    context_.ledger.CountDropped(kind, field.reason);
    if (robot_.sessions.MayNotice(field.field, arrived_)) {
      context_.probe.notices_total.Add();
      taken.frames.push_back(NoticeFrame(seq, field));
    }
  }
}

void Intake::TakeRejected(const UplinkView& uplink, const model::Rejection& rejection,
                          std::size_t kind, Taken& taken) {
  NoteMalformed();
  context_.ledger.CountRejected(kind, rejection.reason);
  taken.frames.push_back(RejectFrame(uplink.seq, rejection));
  robot_.sessions.Remember(session_, uplink.seq, rejection);
  std::string kept;
  if (robot_.sessions.KeepPayload(rejection.reason, arrived_)) {
    kept = uplink.payload.substr(0, context_.limits.payload_bytes_max);
  }
  Append(uplink.seq, storage::QuarantineItem{.rejection = rejection}, std::move(kept),
         uplink.payload.size());
}

void Intake::NoteMalformed() {
  // Now, not the frame's arrival: a large frame may be taken over several seconds.
  const SteadyTime now = context_.clock.Steady();
  if (now - malformed_since_ >= std::chrono::seconds(1)) {
    malformed_since_ = now;
    malformed_ = 0;
  }
  ++malformed_;
}

void Intake::Append(model::Seq seq, std::variant<model::Record, storage::QuarantineItem> content,
                    std::string payload, std::size_t payload_bytes) {
  ++counts_.received;
  SettleRun();
  const std::int64_t grew = robot_.sessions.AddWaiting(session_, seq);
  if (grew == 0) {
    // Another process took the robot since the number was seen: the next look says so.
    ++counts_.superseded;
    new_before_ = 0;
    return;
  }
  counts_.in_flight += grew;
  // Published before the writer can settle it, so that no scrape sees it settled and not received.
  Publish();
  journal_.Append(robot_.sessions, generation_,
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
  std::vector<model::Record>& live = context_.scratch.live;
  if (auto rcan = std::exchange(context_.scratch.rcan, std::nullopt)) {
    ++counts_.received;
    ++counts_.applied;
    robot_.state.Apply(*std::move(rcan), arrived_);
  }
  if (live.empty()) return;
  counts_.received += live.size();
  counts_.applied += live.size();
  robot_.state.Apply(live, arrived_);
  for (model::Record& record : live) context_.judge.Reuse(std::move(record));
  live.clear();
}

void Intake::Publish() {
  context_.ledger.Publish(counts_);
  counts_ = {};
}

}  // namespace uplink::session
