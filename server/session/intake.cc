#include "server/session/intake.h"

#include <array>
#include <span>
#include <utility>

#include "server/session/frames.h"
#include "server/session/mutation.h"

namespace uplink::session {
namespace {

/// A later live message of the same frame replaces these kinds whole.
bool ReplacedWhole(model::Variant variant) {
  return variant == model::Variant::kMotionTelemetry ||
         variant == model::Variant::kStatusTelemetry || variant == model::Variant::kUsageTelemetry;
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

const std::string& PayloadOf(const v1::Uplink& uplink) {
  return uplink.content_case() == v1::Uplink::kRcanRobotState ? uplink.rcan_robot_state()
                                                              : uplink.rover_nexus();
}

schema::Judgement Unsupported(std::string detail) {
  schema::Judgement judgement{.verdict = model::Rejection{}};
  judgement.verdict = model::Rejection{
      .reason = model::RejectReason::kUnsupportedContent, .field = "", .detail = std::move(detail)};
  return judgement;
}

schema::Judgement JudgeContent(const v1::Uplink& uplink, schema::Judge& judge) {
  switch (uplink.content_case()) {
    case v1::Uplink::kRoverNexus:
      return judge.Payload(std::as_bytes(std::span(uplink.rover_nexus())));
    case v1::Uplink::kRcanRobotState:
      return Unsupported("this server does not take rcan_robot_state");
    case v1::Uplink::CONTENT_NOT_SET:
      break;
  }
  return Unsupported("the uplink has no content");
}

}  // namespace

Intake::Intake(const SessionContext& context, fleet::Robot& robot, storage::RobotRef id,
               const model::SessionId& session, std::uint64_t generation)
    : context_(context),
      journal_(context.journals.Of(id->ruri)),
      robot_(robot),
      id_(std::move(id)),
      session_(session),
      generation_(generation) {}

void Intake::Begin(std::unique_ptr<v1::RelayRequest> frame, SteadyTime arrived,
                   SystemTime received_at) {
  frame_ = std::move(frame);
  next_ = 0;
  arrived_ = arrived;
  received_at_ = received_at;
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
  const v1::UplinkBatch& batch = frame_->batch();
  while (next_ < batch.uplinks_size() && !taken.is_void &&
         Holding(outgoing + taken.frames.size()) == Hold::kNone) {
    TakeOne(batch.uplinks(next_), taken);
    ++next_;
  }
  ApplyLive();
  Publish();
  if (next_ >= batch.uplinks_size() || taken.is_void) frame_.reset();
  return taken;
}

void Intake::TakeOne(const v1::Uplink& uplink, Taken& taken) {
  const RobotSessions::Seen seen = robot_.sessions.See(session_, uplink.seq());
  if (seen.place == Place::kVoid) {
    taken.is_void = true;
    return;
  }
  if (seen.place == Place::kDuplicate) {
    ++counts_.received;
    ++counts_.duplicate;
    if (Planted(Mutation::kDuplicateNotAcked)) return;
    ++taken.messages;
    if (!seen.waits) taken.ack_owed = true;
    return;
  }
  ++taken.messages;
  if (seen.missing_first > 0) NoteMissing(seen);
  schema::Judgement judgement = JudgeContent(uplink, context_.judge);
  if (judgement.sign_of_life) {
    robot_.state.SignOfLife(arrived_, received_at_, context_.fleet.presence_limits());
  }
  if (judgement.times_unknown > 0 || judgement.enumerants_unrecognized > 0) {
    context_.ledger.CountOdd(judgement.times_unknown, judgement.enumerants_unrecognized);
  }
  if (const model::Rejection* rejection = judgement.rejection()) {
    TakeRejected(uplink, *rejection, taken);
  } else {
    TakeRecord(uplink, judgement, taken);
  }
}

void Intake::NoteMissing(const RobotSessions::Seen& seen) {
  counts_.missing += seen.missing_last - seen.missing_first + 1;
  robot_.sessions.AddGap();
  journal_.AppendGap(robot_.sessions, generation_,
                     {.robot = id_,
                      .session = session_,
                      .first = seen.missing_first,
                      .last = seen.missing_last,
                      .seen_at = received_at_});
}

void Intake::TakeRecord(const v1::Uplink& uplink, schema::Judgement& judgement, Taken& taken) {
  auto& record = std::get<model::Record>(judgement.verdict);
  ++counts_.records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    NoteDropped(uplink.seq(), record, taken);
    robot_.sessions.AddSettled(session_, uplink.seq());
    live_.push_back(std::move(record));
    return;
  }
  if (ExpiredOnArrival(record.body(), received_at_)) {
    robot_.sessions.AddSettled(session_, uplink.seq());
    ++counts_.received;
    ++counts_.superseded;
    return;
  }
  Append(uplink.seq(), std::move(record), PayloadOf(uplink), PayloadOf(uplink).size());
}

void Intake::NoteDropped(model::Seq seq, const model::Record& record, Taken& taken) {
  if (record.dropped().empty()) return;
  robot_.state.CountDropped(record.dropped().size());
  for (const model::DroppedField& dropped : record.dropped()) {
    context_.ledger.CountDropped(record.variant(), dropped.reason);
    if (robot_.sessions.MayNotice(dropped.field, arrived_)) {
      context_.probe.notices_total.Add();
      taken.frames.push_back(NoticeFrame(seq, dropped));
    }
  }
}

void Intake::TakeRejected(const v1::Uplink& uplink, const model::Rejection& rejection,
                          Taken& taken) {
  NoteMalformed();
  taken.frames.push_back(RejectFrame(uplink.seq(), rejection));
  robot_.sessions.Remember(session_, uplink.seq(), rejection);
  const std::string& payload = PayloadOf(uplink);
  std::string kept;
  if (robot_.sessions.KeepPayload(rejection.reason, arrived_)) {
    kept = payload.substr(0, context_.limits.payload_bytes_max);
  }
  Append(uplink.seq(), storage::QuarantineItem{.rejection = rejection}, std::move(kept),
         payload.size());
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
  const std::int64_t grew = robot_.sessions.AddWaiting(session_, seq);
  if (grew == 0) {
    // Another process took the robot since the number was seen.
    ++counts_.superseded;
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
  if (live_.empty()) return;
  const std::size_t taken = live_.size();
  if (taken > 1) {
    std::array<bool, model::kVariants> replaced{};
    for (std::size_t i = taken; i-- > 0;) {
      const auto variant = static_cast<std::size_t>(live_[i].variant());
      if (!ReplacedWhole(live_[i].variant())) continue;
      if (replaced[variant]) live_.erase(live_.begin() + static_cast<std::ptrdiff_t>(i));
      replaced[variant] = true;
    }
  }
  counts_.received += taken;
  counts_.applied += live_.size();
  counts_.superseded += taken - live_.size();
  robot_.state.Apply(live_);
  live_.clear();
}

void Intake::Publish() {
  context_.ledger.Publish(counts_);
  counts_ = {};
}

}  // namespace uplink::session
