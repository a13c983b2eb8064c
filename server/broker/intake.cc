#include "server/broker/intake.h"

#include <utility>

#include "schema/cyberwave/topic.h"
#include "server/broker/digest.h"
#include "server/broker/message_cost.h"
#include "server/broker/records_of.h"
#include "server/cyberwave/whose.h"
#include "storage/origin.h"

namespace uplink::broker {

using cyberwave::MessageClass;
using cyberwave::TopicKind;

struct Intake::Taking {
  const mqtt::Message& message;
  cyberwave::Arrival arrived;
  /// It was held, and counted then.
  bool held = false;
  Commits::Delivered delivered{};
  cyberwave::Judgement judgement{};
  /// Stays when the judgement is taken.
  cyberwave::Topic topic{};
  MessageCounts counts{};

  [[nodiscard]] const mqtt::Publish& publish() const { return message.publish; }
};

namespace {

Became BecameOf(cyberwave::Outcome outcome) {
  switch (outcome) {
    case cyberwave::Outcome::kApplied:
      return Became::kApplied;
    case cyberwave::Outcome::kSuperseded:
      return Became::kSuperseded;
    case cyberwave::Outcome::kObserved:
      return Became::kObserved;
    case cyberwave::Outcome::kStored:
      return Became::kStored;
    case cyberwave::Outcome::kRejected:  // it does not come so far
    case cyberwave::Outcome::kIgnored:
      break;
  }
  return Became::kIgnored;
}

void CountTopic(BrokerProbe& probe, TopicKind kind) {
  probe.topics[static_cast<std::size_t>(kind)].Add();
}

}  // namespace

Intake::Taken Intake::Take(const mqtt::Message& message, const cyberwave::Arrival& arrived) {
  Taking taking{.message = message, .arrived = arrived};
  taking.counts.received = 1;
  if (TakeOne(taking) == Taken::kDone) return Taken::kDone;
  context_.probe.held.Set(1);
  context_.probe.held_total.Add();
  MessageCounts counts{.received = 1};
  counts.in_flight = 1;
  context_.ledger.Publish(counts);
  return Taken::kHeld;
}

Intake::Taken Intake::TakeHeld(const HeldMessage& held) {
  if (full_ != nullptr && !full_->HasRoom()) return Taken::kHeld;
  Taking taking{.message = held.message(), .arrived = held.arrived(), .held = true};
  taking.counts.in_flight = -1;
  if (TakeOne(taking) == Taken::kHeld) return Taken::kHeld;
  context_.probe.held.Set(0);
  return Taken::kDone;
}

Intake::Taken Intake::TakeOne(Taking& taking) {
  taking.delivered = {.packet_id = taking.publish().id,
                      .digest = {},
                      .ack = taking.message.ack,
                      .arrived = taking.arrived.steady};
  return WasBefore(taking) ? Taken::kDone : Judge(taking);
}

void Intake::DropHeld() {
  context_.probe.held.Set(0);
  MessageCounts counts;
  counts.in_flight = -1;
  counts.Count(Became::kRefused);
  context_.ledger.Publish(counts);
}

void Intake::WakeWhenRoom(robot::StreamRef stream) const {
  if (full_ != nullptr) full_->WhenRoom(stream);
}

bool Intake::WasBefore(Taking& taking) {
  if (taking.message.again) {
    // This connection delivered it before, and one release is enough.
    taking.counts.Count(Became::kDuplicate);
    context_.ledger.Publish(taking.counts);
    return true;
  }
  if (taking.publish().retained) {
    // It may be of any age.
    Settle(taking, Became::kIgnored);
    return true;
  }
  if (taking.delivered.packet_id == 0) return false;
  taking.delivered.digest = DigestOf(taking.publish());
  if (!taking.publish().dup || !context_.commits.IsKnown(taking.delivered)) return false;
  taking.counts.Count(Became::kDuplicate);
  context_.ledger.Publish(taking.counts);
  return true;
}

Intake::Taken Intake::Judge(Taking& taking) {
  const mqtt::Publish& publish = taking.publish();
  taking.judgement =
      publish.payload
          ? cyberwave::JudgeMessage(publish.topic, *publish.payload, context_.terms)
          : cyberwave::JudgeUnread(publish.topic, publish.payload_bytes, context_.terms);
  const cyberwave::Judgement& judgement = taking.judgement;
  taking.topic = judgement.topic;
  was_stray_ = judgement.topic.kind == TopicKind::kOther;
  if (was_stray_) {
    Settle(taking, Became::kIgnored);
    return Taken::kDone;
  }
  if (judgement.topic.kind == TopicKind::kPing && judgement.rejection() == nullptr) {
    CountTopic(context_.probe, TopicKind::kPing);
    pongs_.Answer(taking.topic, publish.correlation, taking.arrived);
    Settle(taking, Became::kObserved);
    return Taken::kDone;
  }
  const auto place = PlaceOf(taking);
  if (!place) {
    Settle(taking, Became::kObserved);
    return Taken::kDone;
  }
  return place->stream != nullptr ? Write(taking, *place->stream) : WriteNowhere(taking, *place);
}

Intake::Taken Intake::WriteNowhere(Taking& taking, const TwinStreams::Opened& place) {
  full_ = nullptr;
  if (!place.too_many) return Wait(taking);
  if (!taking.held) {
    context_.probe.robots_over.Add();
    context_.refused_log.Write(
        log::Level::kWarn, "twin_refused",
        {{"twin", taking.topic.id.ToText()}, {"why", "there are as many robots as may be"}});
  }
  const bool durable = taking.judgement.message_class == MessageClass::kDurable;
  const TwinStreams::Opened stand_in = context_.streams.FindOrOpenStandIn(taking.topic.prefix);
  if (!durable || stand_in.stream == nullptr) {
    Settle(taking, Became::kRefused);
    return Taken::kDone;
  }
  if (!HasRoom(*stand_in.stream)) return Wait(taking);
  // It is acked, so it is kept: where an operator looks for what went wrong.
  Reject(taking, *stand_in.stream,
         {.reason = model::RejectReason::kTooManyItems,
          .field = "topic",
          .detail = "a twin more than cyberwave.robots_max or limits.robots_max"});
  return Taken::kDone;
}

Intake::Taken Intake::Wait(Taking& taking) {
  if (taking.delivered.packet_id != 0) return Taken::kHeld;
  Settle(taking, Became::kRefused);
  return Taken::kDone;
}

std::optional<TwinStreams::Opened> Intake::PlaceOf(const Taking& taking) {
  const cyberwave::Judgement& judgement = taking.judgement;
  const cyberwave::Topic& topic = judgement.topic;
  if (cyberwave::RobotOf(judgement).has_value()) {
    const std::string ruri = cyberwave::RuriOf(judgement);
    if (TwinStream* stream = context_.streams.Find(ruri);
        stream != nullptr && !stream->ending && !stream->ended) {
      return TwinStreams::Opened{.stream = stream};
    }
    const bool durable = judgement.message_class == MessageClass::kDurable;
    const bool speaks = cyberwave::SignOfLifeOf(judgement) == cyberwave::RobotOf(judgement) ||
                        (durable && judgement.rejection() == nullptr);
    // Who only commands a twin, or looks at it, does not make it exist.
    if (speaks || context_.fleet.Find(ruri) != nullptr) {
      return context_.streams.FindOrOpen({.ruri = ruri, .prefix = topic.prefix, .twin = topic.id});
    }
    if (judgement.rejection() == nullptr) return std::nullopt;
  }
  return context_.streams.FindOrOpenStandIn(topic.prefix);
}

bool Intake::HasRoom(TwinStream& stream) {
  const bool room =
      stream.journal->HasRoom() &&
      stream.robot->flow.LookAtDisk(context_.clock.Steady()).by == robot::HeldBack::kNone;
  full_ = stream.journal->HasRoom() ? nullptr : stream.journal;
  return room;
}

void Intake::NoteLife(const Taking& taking, TwinStream& stream) const {
  const auto sign = cyberwave::SignOfLifeOf(taking.judgement);
  if (!sign || stream.twin == nullptr || sign != cyberwave::RobotOf(taking.judgement)) return;
  stream.robot->state.SignOfLife(taking.arrived.steady, taking.arrived.system,
                                 context_.fleet.presence_limits_of(*stream.robot));
}

Intake::Taken Intake::Write(Taking& taking, TwinStream& stream) {
  stream.used_at = taking.arrived.steady;
  if (!taking.held) NoteLife(taking, stream);
  const std::size_t records = RecordsAtMost(taking.judgement, stream);
  if (records > 0 && !HasRoom(stream)) return Wait(taking);
  CountTopic(context_.probe, taking.topic.kind);
  const auto fill = context_.journal_over_half() ? cyberwave::JournalFill::kOverHalf
                                                 : cyberwave::JournalFill::kUpToHalf;
  if (const auto limited =
          LimitOf(taking.judgement, stream, records, fill, context_.clock.Steady())) {
    context_.limited_log.Write(log::Level::kWarn, "twin_limited",
                               {{"robot", stream.ruri()}, {"why", limited->detail}});
    ++taking.counts.rejects[static_cast<std::size_t>(limited->reason)];
    Settle(taking, Became::kRejected);
  } else if (const model::Rejection* rejection = taking.judgement.rejection()) {
    Reject(taking, stream, *rejection);
  } else {
    NoteOdd(taking);
    Apply(taking, stream);
  }
  return Taken::kDone;
}

void Intake::Reject(Taking& taking, TwinStream& stream, const model::Rejection& rejection) {
  const mqtt::Publish& publish = taking.publish();
  std::string kept;
  if (taking.judgement.may_be_kept && publish.payload && !stream.robot->flow.disk_limits() &&
      stream.robot->sessions.KeepPayload(rejection.reason, taking.arrived.steady)) {
    kept = publish.payload->substr(0, context_.payload_bytes_max);
    stream.robot->flow.CountKept(kept.size());
  }
  Append(taking, stream, RecordsOf(rejection, publish, taking.arrived.system, std::move(kept)),
         rejection.reason);
}

void Intake::Apply(Taking& taking, TwinStream& stream) {
  cyberwave::Applied applied =
      stream.twin == nullptr
          ? cyberwave::ApplyToNoRobot(std::move(taking.judgement))
          : context_.twins.Apply(*stream.twin, std::move(taking.judgement), taking.arrived);
  for (const model::DroppedField& field : applied.dropped) {
    ++taking.counts.dropped[static_cast<std::size_t>(field.reason)];
  }
  stream.robot->state.CountDropped(applied.without_room);
  if (applied.records.empty()) return Settle(taking, BecameOf(applied.outcome));
  Append(taking, stream,
         RecordsOf(std::move(applied.records), taking.publish(), taking.arrived.system),
         std::nullopt);
}

void Intake::Append(Taking& taking, TwinStream& stream, std::vector<storage::CommitRecord> records,
                    std::optional<model::RejectReason> rejected) {
  const storage::OriginRef origin = storage::OriginOf(
      model::MessageSource::kCyberwave, cyberwave::KeptTopic(taking.publish().topic, taking.topic),
      context_.commits.hold());
  for (storage::CommitRecord& record : records) record.origin = origin;
  taking.counts.in_flight += 1;
  // Before the writer can settle it, so that no scrape sees it settled and not received.
  context_.ledger.Publish(taking.counts);
  if (context_.commits.Append(stream, taking.delivered, std::move(records), rejected)) return;
  // Another process took the robot since. A message at QoS 1 comes again.
  MessageCounts counts;
  counts.in_flight = -1;
  counts.Count(Became::kRefused);
  context_.ledger.Publish(counts);
}

void Intake::NoteOdd(Taking& taking) const {
  cyberwave::Judgement& judgement = taking.judgement;
  for (const model::DroppedField& field : judgement.dropped) {
    ++taking.counts.dropped[static_cast<std::size_t>(field.reason)];
  }
  for (const model::UntoldFields& fields : judgement.untold) {
    taking.counts.dropped[static_cast<std::size_t>(fields.reason)] += fields.fields;
  }
  if (judgement.times_unknown > 0) context_.probe.times_unknown.Add(judgement.times_unknown);
  if (judgement.control_characters > 0) {
    context_.probe.control_characters.Add(judgement.control_characters);
  }
}

void Intake::Settle(Taking& taking, Became became) {
  taking.counts.Count(became);
  context_.ledger.Publish(taking.counts);
  context_.commits.SettleAtOnce(taking.delivered);
}

}  // namespace uplink::broker
