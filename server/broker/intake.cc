#include "server/broker/intake.h"

#include <utility>
#include <variant>

#include "schema/cyberwave/topic.h"
#include "server/broker/digest.h"
#include "server/cyberwave/whose.h"

namespace uplink::broker {

using cyberwave::MessageClass;
using cyberwave::TopicKind;

struct Intake::Processing {
  const mqtt::Message& message;
  cyberwave::Arrival arrived;
  /// It was held back, and is counted as in flight.
  bool held_back = false;
  Commits::Delivered delivered{};
  cyberwave::Judgement judgement{};
  /// Its twin exceeds the bound.
  bool exceeds_robots_max = false;

  [[nodiscard]] const mqtt::Publish& publish() const { return message.publish; }
  [[nodiscard]] cyberwave::TopicKind kind() const { return judgement.topic.kind; }
};

Intake::Processed Intake::Process(const mqtt::Message& message, const cyberwave::Arrival& arrived) {
  Processing processing{.message = message, .arrived = arrived};
  const Processed processed = ProcessOne(processing);
  if (processed == Processed::kHeldBack) {
    context_.probe.held_back.Set(1);
    context_.probe.held_back_total.Add();
    port_.CountHeld();
  }
  port_.Publish();
  return processed;
}

Intake::Processed Intake::ProcessHeldBack(const HeldBackMessage& held) {
  if (full_ != nullptr && !full_->HasRoom()) return Processed::kHeldBack;
  Processing processing{.message = held.message(), .arrived = held.arrived(), .held_back = true};
  if (ProcessOne(processing) == Processed::kHeldBack) return Processed::kHeldBack;
  port_.Publish();
  context_.probe.held_back.Set(0);
  return Processed::kDone;
}

Intake::Processed Intake::ProcessOne(Processing& processing) {
  was_stray_ = false;
  processing.delivered = {.packet_id = processing.publish().id,
                          .digest = {},
                          .ack = processing.message.ack,
                          .arrived = processing.arrived.steady};
  return HandleRedelivery(processing) ? Processed::kDone : Judge(processing);
}

void Intake::DropHeldBack() {
  context_.probe.held_back.Set(0);
  port_.Count({.is_counted = true}, metrics::Became::kRefused);
  port_.Publish();
}

void Intake::Refuse() {
  port_.Count({}, metrics::Became::kRefused);
  port_.Publish();
}

void Intake::WakeWhenRoom(loop::StreamRef stream) const {
  if (full_ != nullptr) full_->WhenRoom(stream);
}

bool Intake::HandleRedelivery(Processing& processing) {
  if (processing.message.again) {
    // This connection delivered it before, and one ack is enough.
    Count(processing, metrics::Became::kDuplicate);
    return true;
  }
  if (processing.publish().retained) {
    // A retained message may be of any age.
    Settle(processing, metrics::Became::kIgnored);
    return true;
  }
  if (processing.delivered.packet_id == 0) return false;
  processing.delivered.digest = DigestOf(processing.publish());
  if (!processing.publish().dup || !context_.commits.AckIfKnown(processing.delivered)) return false;
  Count(processing, metrics::Became::kDuplicate);
  return true;
}

Intake::Processed Intake::Judge(Processing& processing) {
  PayloadJudge::Judged judged = payloads_.Judge(processing.publish(), processing.arrived.steady);
  processing.judgement = std::move(judged.judgement);
  if (judged.over_budget) {
    return RejectLimited(processing);
  }
  was_stray_ = processing.kind() == TopicKind::kOther;
  if (was_stray_) {
    Settle(processing, metrics::Became::kIgnored);
    return Processed::kDone;
  }
  if (processing.kind() == TopicKind::kPing) {
    AnswerPing(processing);
    return Processed::kDone;
  }
  const auto place = context_.streams.PlaceOf(processing.judgement);
  if (!place) {
    Settle(processing, metrics::Became::kObserved);
    return Processed::kDone;
  }
  if (place->blocked) {
    Settle(processing, metrics::Became::kBlocked);
    return Processed::kDone;
  }
  if (place->stream == nullptr) return HandleUnplaced(processing, *place);
  if (!processing.held_back &&
      limits_.ExceedsUnknownSenderBudget({.judgement = processing.judgement,
                                          .publish = processing.publish(),
                                          .arrived = processing.arrived.steady},
                                         *place->stream)) {
    return RejectLimited(processing);
  }
  place->stream->used_at = processing.arrived.steady;
  // Only when the message arrives, not when it is tried again.
  if (!processing.held_back) {
    NoteLife(processing, *place->stream);
    NoteConnection(processing, *place->stream);
  }
  return Offer(processing, *place->stream);
}

void Intake::AnswerPing(Processing& processing) {
  context_.probe.topics[static_cast<std::size_t>(TopicKind::kPing)].Add();
  if (const model::Rejection* rejection = processing.judgement.rejection()) {
    // Any sender may ping under any name: a row would name no robot.
    return RejectUnkept(processing, rejection->reason);
  }
  pongs_.Answer(processing.judgement.topic, processing.publish().correlation, processing.arrived);
  Settle(processing, metrics::Became::kObserved);
}

void Intake::RejectUnkept(Processing& processing, model::RejectReason reason) {
  ++port_.counts().rejects[static_cast<std::size_t>(reason)];
  Settle(processing, metrics::Became::kRejected);
}

Intake::Processed Intake::RejectLimited(Processing& processing) {
  context_.probe.topics[static_cast<std::size_t>(processing.kind())].Add();
  RejectUnkept(processing, model::RejectReason::kRateLimited);
  return Processed::kDone;
}

Intake::Processed Intake::HandleUnplaced(Processing& processing, const TwinStreams::Opened& place) {
  full_ = nullptr;
  if (!place.too_many) return Wait(processing);
  if (!processing.held_back) {
    context_.probe.twins_refused.Add();
    context_.refused_log.Write(log::Level::kWarn, "twin_refused",
                               {{"twin", processing.judgement.topic.id.ToText()},
                                {"why", "there are as many robots as may be"}});
  }
  const bool durable = processing.judgement.message_class == MessageClass::kDurable;
  if (!durable) {
    Settle(processing, metrics::Became::kRefused);
    return Processed::kDone;
  }
  const TwinStreams::Opened stand_in =
      context_.streams.FindOrOpenStandIn(processing.judgement.topic.prefix);
  if (stand_in.stream == nullptr) return Wait(processing);
  // It is acked, so it is kept where an operator looks for errors.
  processing.judgement.verdict =
      model::Rejection{.reason = model::RejectReason::kTooManyItems,
                       .field = "topic",
                       .detail = "a twin more than cyberwave.robots_max or limits.robots_max"};
  processing.exceeds_robots_max = true;
  return Offer(processing, *stand_in.stream);
}

Intake::Processed Intake::Wait(Processing& processing) {
  if (processing.delivered.packet_id != 0) return Processed::kHeldBack;
  Settle(processing, metrics::Became::kRefused);
  return Processed::kDone;
}

void Intake::NoteLife(const Processing& processing, TwinStream& stream) {
  const auto sign = cyberwave::SignOfLifeOf(processing.judgement);
  if (!sign || stream.twin == nullptr || sign != cyberwave::RobotOf(processing.judgement)) return;
  port_.NoteLife(stream.line(), processing.arrived.steady, processing.arrived.system);
}

void Intake::NoteConnection(const Processing& processing, TwinStream& stream) {
  const cyberwave::Judgement& judgement = processing.judgement;
  const auto robot = cyberwave::RobotOf(judgement);
  if (!robot) return;
  const model::cyberwave::Body* body = judgement.body();
  context_.streams.Hear(
      stream, {.session = judgement.head.session_id,
               .live = cyberwave::SignOfLifeOf(judgement) == robot,
               .mark = body == nullptr ? nullptr : std::get_if<model::cyberwave::Mark>(body),
               .bytes = judgement.payload_bytes,
               .arrived = processing.arrived});
}

Intake::Processed Intake::Offer(Processing& processing, TwinStream& stream) {
  TwinMessage message(sources_, {.publish = processing.publish(),
                                 .arrived = processing.arrived,
                                 .is_counted = processing.held_back,
                                 .delivered = processing.delivered,
                                 .judgement = processing.judgement,
                                 .stream = stream,
                                 .exceeds_robots_max = processing.exceeds_robots_max});
  const ingest::Port::Offered offered = port_.Offer(stream.line(), message);
  if (!offered.block.none()) Tell(stream, offered);
  if (offered.answer != ingest::Port::Answer::kWaits) return Processed::kDone;
  full_ = offered.block.by == robot::HeldBack::kJournal ? stream.journal : nullptr;
  return Processed::kHeldBack;
}

void Intake::Tell(TwinStream& stream, const ingest::Port::Offered& offered) {
  const SteadyTime now = context_.clock.Steady();
  if (offered.block.is_excess) {
    const bool by_disk = offered.block.by == robot::HeldBack::kDisk;
    context_.limited_log.Tell(
        stream,
        by_disk ? "more than it may store while the store's disk is short (store.free_min)"
                : "more than is stored of one robot (limits.durable_*)",
        now);
  } else if (offered.block.by == robot::HeldBack::kJournalShare) {
    context_.limited_log.Tell(stream, "its share of the journal is full (journal.robot_share)",
                              now);
  }
}

void Intake::Settle(Processing& processing, metrics::Became became) {
  Count(processing, became);
  context_.commits.SettleAtOnce(processing.delivered, nullptr);
}

void Intake::Count(const Processing& processing, metrics::Became became) {
  port_.Count({.is_counted = processing.held_back}, became);
}

}  // namespace uplink::broker
