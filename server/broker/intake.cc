#include "server/broker/intake.h"

#include <utility>

#include "schema/cyberwave/topic.h"
#include "server/broker/digest.h"
#include "server/broker/message_cost.h"
#include "server/broker/outcome.h"
#include "server/broker/records_of.h"
#include "server/cyberwave/whose.h"
#include "storage/origin.h"

namespace uplink::broker {

using cyberwave::MessageClass;
using cyberwave::TopicKind;

struct Intake::Processing {
  const mqtt::Message& message;
  cyberwave::Arrival arrived;
  /// It was held, and counted then.
  bool held_back = false;
  Commits::Delivered delivered{};
  cyberwave::Judgement judgement{};
  /// Stays when the judgement is taken.
  cyberwave::Topic topic{};
  /// Where it is written to; null while that is not known.
  TwinStream* stream = nullptr;
  metrics::MessageCounts counts{};
  /// That it brings no record is a matter of which faults the store has, as remembered here.
  bool rests_on_store = false;

  [[nodiscard]] const mqtt::Publish& publish() const { return message.publish; }
  [[nodiscard]] MessageLimits::Message judged() const {
    return {.judgement = judgement, .publish = message.publish, .arrived = arrived.steady};
  }
};

namespace {

void CountTopic(BrokerProbe& probe, TopicKind kind) {
  probe.topics[static_cast<std::size_t>(kind)].Add();
}

}  // namespace

Intake::Processed Intake::Process(const mqtt::Message& message, const cyberwave::Arrival& arrived) {
  Processing processing{.message = message, .arrived = arrived};
  processing.counts.received = 1;
  if (ProcessOne(processing) == Processed::kDone) return Processed::kDone;
  context_.probe.held_back.Set(1);
  context_.probe.held_back_total.Add();
  context_.ledger.Publish({.received = 1, .in_flight = 1});
  return Processed::kHeldBack;
}

Intake::Processed Intake::ProcessHeldBack(const HeldBackMessage& held) {
  if (full_ != nullptr && !full_->HasRoom()) return Processed::kHeldBack;
  Processing processing{.message = held.message(), .arrived = held.arrived(), .held_back = true};
  processing.counts.in_flight = -1;
  if (ProcessOne(processing) == Processed::kHeldBack) return Processed::kHeldBack;
  context_.probe.held_back.Set(0);
  return Processed::kDone;
}

Intake::Processed Intake::ProcessOne(Processing& processing) {
  was_stray_ = false;
  processing.delivered = {.packet_id = processing.publish().id,
                          .digest = {},
                          .ack = processing.message.ack,
                          .arrived = processing.arrived.steady};
  return WasBefore(processing) ? Processed::kDone : Judge(processing);
}

void Intake::DropHeldBack() {
  context_.probe.held_back.Set(0);
  metrics::MessageCounts counts;
  counts.in_flight = -1;
  counts.Count(metrics::Became::kRefused);
  context_.ledger.Publish(counts);
}

void Intake::Refuse() {
  metrics::MessageCounts counts{.received = 1};
  counts.Count(metrics::Became::kRefused);
  context_.ledger.Publish(counts);
}

void Intake::WakeWhenRoom(robot::StreamRef stream) const {
  if (full_ != nullptr) full_->WhenRoom(stream);
}

bool Intake::WasBefore(Processing& processing) {
  if (processing.message.again) {
    // This connection delivered it before, and one release is enough.
    processing.counts.Count(metrics::Became::kDuplicate);
    context_.ledger.Publish(processing.counts);
    return true;
  }
  if (processing.publish().retained) {
    // It may be of any age.
    Settle(processing, metrics::Became::kIgnored);
    return true;
  }
  if (processing.delivered.packet_id == 0) return false;
  processing.delivered.digest = DigestOf(processing.publish());
  if (!processing.publish().dup || !context_.commits.IsKnown(processing.delivered)) return false;
  processing.counts.Count(metrics::Became::kDuplicate);
  context_.ledger.Publish(processing.counts);
  return true;
}

Intake::Processed Intake::Judge(Processing& processing) {
  PayloadJudge::Judged judged = payloads_.Judge(processing.publish(), processing.arrived.steady);
  processing.judgement = std::move(judged.judgement);
  processing.topic = processing.judgement.topic;
  if (judged.over_budget) {
    return RejectLimited(processing);
  }
  was_stray_ = processing.topic.kind == TopicKind::kOther;
  if (was_stray_) {
    Settle(processing, metrics::Became::kIgnored);
    return Processed::kDone;
  }
  if (processing.topic.kind == TopicKind::kPing) {
    AnswerPing(processing);
    return Processed::kDone;
  }
  const auto place = context_.streams.PlaceOf(processing.judgement);
  if (!place) {
    Settle(processing, metrics::Became::kObserved);
    return Processed::kDone;
  }
  if (place->stream == nullptr) return WriteNowhere(processing, *place);
  if (!processing.held_back &&
      limits_.ExceedsUnknownSenderBudget(processing.judged(), *place->stream)) {
    return RejectLimited(processing);
  }
  return Write(processing, *place->stream);
}

void Intake::AnswerPing(Processing& processing) {
  CountTopic(context_.probe, TopicKind::kPing);
  if (const model::Rejection* rejection = processing.judgement.rejection()) {
    // Any sender may ping under any name: a row would name no robot.
    return RejectUnkept(processing, rejection->reason);
  }
  pongs_.Answer(processing.topic, processing.publish().correlation, processing.arrived);
  Settle(processing, metrics::Became::kObserved);
}

void Intake::RejectUnkept(Processing& processing, model::RejectReason reason) {
  ++processing.counts.rejects[static_cast<std::size_t>(reason)];
  Settle(processing, metrics::Became::kRejected);
}

Intake::Processed Intake::RejectLimited(Processing& processing) {
  CountTopic(context_.probe, processing.topic.kind);
  RejectUnkept(processing, model::RejectReason::kRateLimited);
  return Processed::kDone;
}

Intake::Processed Intake::WriteNowhere(Processing& processing, const TwinStreams::Opened& place) {
  full_ = nullptr;
  if (!place.too_many) return Wait(processing);
  if (!processing.held_back) {
    context_.probe.twins_refused.Add();
    context_.refused_log.Write(
        log::Level::kWarn, "twin_refused",
        {{"twin", processing.topic.id.ToText()}, {"why", "there are as many robots as may be"}});
  }
  const bool durable = processing.judgement.message_class == MessageClass::kDurable;
  if (!durable) {
    Settle(processing, metrics::Became::kRefused);
    return Processed::kDone;
  }
  const TwinStreams::Opened stand_in = context_.streams.FindOrOpenStandIn(processing.topic.prefix);
  if (stand_in.stream == nullptr || !HasRoom(*stand_in.stream)) return Wait(processing);
  // It is acked, so it is kept: where an operator looks for what went wrong.
  Reject(processing, *stand_in.stream,
         {.reason = model::RejectReason::kTooManyItems,
          .field = "topic",
          .detail = "a twin more than cyberwave.robots_max or limits.robots_max"});
  return Processed::kDone;
}

Intake::Processed Intake::Wait(Processing& processing) {
  if (processing.delivered.packet_id != 0) return Processed::kHeldBack;
  Settle(processing, metrics::Became::kRefused);
  return Processed::kDone;
}

bool Intake::HasRoom(TwinStream& stream) {
  const bool room =
      stream.journal->HasRoom() &&
      stream.robot->flow.LookAtDisk(context_.clock.Steady()).by == robot::HeldBack::kNone;
  full_ = stream.journal->HasRoom() ? nullptr : stream.journal;
  return room;
}

bool Intake::HasShare(const Processing& processing, const TwinStream& stream) const {
  // At QoS 1 it would hold all others back with it, and each ack holds its publisher back.
  if (processing.delivered.packet_id != 0) return true;
  return stream.journal->RoomFor(stream.robot->sessions.journal_use(),
                                 processing.publish().payload_bytes) != journal::Room::kShareFull;
}

void Intake::NoteLife(const Processing& processing, TwinStream& stream) const {
  const auto sign = cyberwave::SignOfLifeOf(processing.judgement);
  if (!sign || stream.twin == nullptr || sign != cyberwave::RobotOf(processing.judgement)) return;
  stream.robot->state.SignOfLife(processing.arrived.steady, processing.arrived.system,
                                 context_.fleet.presence_limits_of(*stream.robot));
}

Intake::Processed Intake::Write(Processing& processing, TwinStream& stream) {
  processing.stream = &stream;
  stream.used_at = processing.arrived.steady;
  if (!processing.held_back) NoteLife(processing, stream);
  const std::size_t records = RecordsAtMost(processing.judgement, stream);
  if (records > 0 && limits_.IsPastFlow(processing.judged(), stream)) {
    return RejectLimited(processing);
  }
  if (records > 0 && !HasRoom(stream)) return Wait(processing);
  if (records > 0 && !HasShare(processing, stream)) {
    context_.limited_log.Tell(stream, "its share of the journal is full (journal.robot_share)",
                              context_.clock.Steady());
    return Wait(processing);
  }
  CountTopic(context_.probe, processing.topic.kind);
  if (const auto limited = limits_.Limit(processing.judged(), stream, records)) {
    RejectUnkept(processing, *limited);
  } else if (const model::Rejection* rejection = processing.judgement.rejection()) {
    Reject(processing, stream, *rejection);
  } else {
    CountOdd(processing.judgement, context_.ledger);
    Apply(processing, stream);
  }
  return Processed::kDone;
}

void Intake::Reject(Processing& processing, TwinStream& stream, const model::Rejection& rejection) {
  const mqtt::Publish& publish = processing.publish();
  std::string kept;
  if (processing.judgement.may_be_kept && publish.payload && !stream.robot->flow.disk_limits() &&
      stream.robot->sessions.KeepPayload(rejection.reason, processing.arrived.steady)) {
    kept = publish.payload->substr(0, context_.payload_bytes_max);
    stream.robot->flow.CountKept(kept.size());
  }
  Append(processing, stream,
         RecordsOf(rejection, publish, processing.arrived.system, std::move(kept)),
         rejection.reason);
}

void Intake::Apply(Processing& processing, TwinStream& stream) {
  cyberwave::Applied applied =
      stream.twin == nullptr
          ? cyberwave::ApplyToNoRobot(std::move(processing.judgement))
          : context_.twins.Apply(*stream.twin, std::move(processing.judgement), processing.arrived);
  CountDropped(applied.dropped, context_.ledger);
  stream.robot->state.CountDropped(applied.without_room);
  processing.rests_on_store = processing.topic.kind == TopicKind::kMetrics;
  if (applied.records.empty()) return Settle(processing, BecameOf(applied.outcome));
  Append(processing, stream,
         RecordsOf(std::move(applied.records), processing.publish(), processing.arrived.system),
         std::nullopt);
}

void Intake::Append(Processing& processing, TwinStream& stream,
                    std::vector<storage::CommitRecord> records,
                    std::optional<model::RejectReason> rejected) {
  const storage::OriginRef origin = storage::OriginOf(
      model::MessageSource::kCyberwave,
      cyberwave::KeptTopic(processing.publish().topic, processing.topic), context_.commits.hold());
  for (storage::CommitRecord& record : records) record.origin = origin;
  limits_.TakeFlow(stream, records, processing.publish().payload_bytes);
  processing.counts.in_flight += 1;
  // Before the writer can settle it, so that no scrape sees it settled and not received.
  context_.ledger.Publish(processing.counts);
  if (context_.commits.Append(stream, processing.delivered, std::move(records), rejected)) return;
  // Another process adopted the robot since. A message at QoS 1 comes again.
  metrics::MessageCounts counts;
  counts.in_flight = -1;
  counts.Count(metrics::Became::kRefused);
  context_.ledger.Publish(counts);
}

void Intake::Settle(Processing& processing, metrics::Became became) {
  processing.counts.Count(became);
  context_.ledger.Publish(processing.counts);
  if (processing.rests_on_store) {
    context_.commits.SettleAfterCommit(processing.delivered, *processing.stream);
  } else {
    context_.commits.SettleAtOnce(processing.delivered, processing.stream);
  }
}

}  // namespace uplink::broker
