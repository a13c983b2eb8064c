#include "server/broker/commits.h"

#include <algorithm>
#include <utility>

#include "server/journal/entry.h"
#include "server/robot/mutation.h"

namespace uplink::broker {
namespace {

/// Its commits show that the store has the deliveries that it confirmed. They are read again if any
/// journal reports a new connection to the store.
constexpr std::size_t kFirstShard = 0;

}  // namespace

void Commits::Begin(storage::TopicHoldRef hold, const storage::DeliveryMemory& memory) {
  hold_ = std::move(hold);
  redeliveries_.Begin(memory);
}

storage::Deliveries Commits::EndSession() {
  return {.hold = hold_, .rows = {redeliveries_.EndSession()}};
}

void Commits::OnCommitted(std::size_t shard) {
  const std::vector<mqtt::AckHandle> acks = after_commit_.Answered(shard);
  due_.insert(due_.end(), acks.begin(), acks.end());
}

bool Commits::AckIfKnown(const Delivered& message) {
  if (robot::Planted(robot::Mutation::kRedeliveryForgotten)) return false;
  const Redeliveries::Found found = redeliveries_.Find(message.packet_id, *message.digest);
  if (found.known == Redeliveries::Known::kNo) return false;
  if (found.known == Redeliveries::Known::kSettled) {
    AckAfterCommit(found.rests_on.value_or(kFirstShard), message.ack);
    return true;
  }
  TwinStream* stream = context_.streams.FindById(found.stream);
  if (stream == nullptr) return false;
  const auto waits = std::ranges::find(stream->waiting, found.number, &WaitingMessage::number);
  if (waits == stream->waiting.end()) return false;
  // The ack goes to the connection that delivered the message last.
  waits->ack = message.ack;
  return true;
}

void Commits::AckAfterCommit(std::size_t shard, const std::optional<mqtt::AckHandle>& ack) {
  if (!ack) return;
  if (robot::Planted(robot::Mutation::kSettledAckedFromMemory)) {
    due_.push_back(*ack);
  } else {
    after_commit_.Add(shard, *ack);
  }
}

void Commits::SettleAtOnce(const Delivered& message, TwinStream* stream) {
  if (message.ack) due_.push_back(*message.ack);
  if (message.packet_id == 0) return;
  if (!message.digest) return redeliveries_.Expire(message.packet_id);
  redeliveries_.AddSettled(message.packet_id, *message.digest,
                           {.stream = stream == nullptr ? 0 : stream->id});
  if (stream != nullptr) NoteSettled(*stream, message.packet_id);
}

void Commits::SettleAfterCommit(const Delivered& message, TwinStream& stream) {
  if (message.packet_id == 0) return;
  const std::size_t shard = after_commit_.ShardOf(*stream.journal);
  redeliveries_.AddSettled(message.packet_id, *message.digest,
                           {.stream = stream.id, .rests_on = shard});
  NoteSettled(stream, message.packet_id);
  AckAfterCommit(shard, message.ack);
}

void Commits::NoteSettled(TwinStream& stream, std::uint16_t packet_id) {
  std::vector<std::uint16_t>& settled = stream.settled;
  if (settled.size() == settled.capacity() && !settled.empty()) {
    redeliveries_.KeepSettled(stream.id, settled);
    // Reserves double, so that this runs seldom, even if more than half are kept.
    settled.reserve(2 * settled.size() + 1);
  }
  settled.push_back(packet_id);
}

storage::Deliveries Commits::TakeExpired() {
  return {.hold = hold_, .rows = redeliveries_.TakeExpired()};
}

std::vector<storage::Delivery> Commits::DeliveriesWith(TwinStream& stream,
                                                       const Delivered& message) {
  std::vector<storage::Delivery> numbered =
      redeliveries_.Number(stream.id, std::exchange(stream.settled, {}));
  if (message.packet_id == 0) return numbered;
  const storage::Delivery own{.number = redeliveries_.NextNumber(),
                              .packet_id = message.packet_id,
                              .digest = message.digest};
  redeliveries_.AddWaiting(own, stream.id);
  numbered.push_back(own);
  return numbered;
}

bool Commits::Number(TwinStream& stream, const Delivered& message,
                     std::vector<storage::CommitRecord>& records,
                     std::optional<model::RejectReason> rejected) {
  WaitingMessage waiting{.ack = message.ack,
                         .packet_id = message.packet_id,
                         .first = stream.last_seq + 1,
                         .last = stream.last_seq + records.size(),
                         .rejected = rejected,
                         .arrived = message.arrived};
  for (storage::CommitRecord& record : records) {
    record.seq = ++stream.last_seq;
    const std::size_t bytes = journal::CostOf(record);
    if (stream.robot->sessions.AddWaiting(stream.session, record.seq, bytes) == 0) return false;
  }
  std::vector<storage::Delivery> numbered = DeliveriesWith(stream, message);
  if (!numbered.empty()) {
    waiting.earlier.reserve(numbered.size() - 1);
    for (const storage::Delivery& delivery : numbered) {
      if (delivery.packet_id == message.packet_id) {
        waiting.number = delivery.number;
      } else {
        waiting.earlier.push_back({delivery.packet_id, delivery.number});
      }
    }
    records.back().message_end = storage::MessageEnd{
        .deliveries = std::move(numbered), .records = static_cast<std::uint32_t>(records.size())};
  }
  if (robot::Planted(robot::Mutation::kMessageAckedOnArrival) && waiting.ack) {
    due_.push_back(*std::exchange(waiting.ack, std::nullopt));
  }
  stream.waiting.push_back(std::move(waiting));
  context_.probe.records.Add(static_cast<std::int64_t>(records.size()));
  return true;
}

void Commits::OnWake(std::uint64_t id) {
  TwinStream* stream = context_.streams.FindById(id);
  if (stream == nullptr) return;
  const robot::Standing standing = stream->robot->sessions.StandingOf(stream->self);
  // First report what was settled before the robot was lost.
  Settle(*stream, stream->robot->sessions.Take(stream->session));
  if (standing == robot::Standing::kEnded) stream->ended = true;
  // What was taken before is stored; its next message finds that it is blocked.
  if (standing == robot::Standing::kBlocked) stream->ending = true;
  const bool goes_on =
      standing == robot::Standing::kCurrent || standing == robot::Standing::kBlocked;
  if (!goes_on && !stream->ended) return Fence(*stream);
  if (!stream->waiting.empty()) return;
  if (stream->ended) {
    context_.streams.Drop(*stream);
  } else if (stream->ending) {
    const bool blocked = standing == robot::Standing::kBlocked;
    context_.streams.Close(
        *stream, blocked ? transport::EndCause::kBlocked : transport::EndCause::kSuperseded);
  }
}

void Commits::Settle(TwinStream& stream, const robot::Progress& progress) {
  const SteadyTime now = context_.clock.Steady();
  auto refused = progress.rejects.begin();
  while (!stream.waiting.empty() && stream.waiting.front().last <= progress.through) {
    const WaitingMessage message = std::move(stream.waiting.front());
    stream.waiting.pop_front();
    std::optional<model::RejectReason> reason = message.rejected;
    // The store's refusals are in the order of the commits.
    for (; refused != progress.rejects.end() && refused->seq <= message.last; ++refused) {
      if (refused->seq >= message.first && !reason) reason = refused->rejection.reason;
    }
    if (message.packet_id != 0) redeliveries_.Commit(message.packet_id, message.number);
    for (const auto& [packet_id, number] : message.earlier) {
      redeliveries_.Commit(packet_id, number);
    }
    if (message.ack) due_.push_back(*message.ack);
    context_.probe.ack_seconds.ObserveSince(message.arrived, now);
    Count(reason ? metrics::Became::kRejected : metrics::Became::kStored, reason);
  }
}

void Commits::Count(metrics::Became became, std::optional<model::RejectReason> reason) {
  metrics::MessageCounts counts{.in_flight = -1};
  counts.Count(became);
  if (reason) ++counts.rejects[static_cast<std::size_t>(*reason)];
  context_.ledger.Publish(counts);
}

void Commits::Fence(TwinStream& stream) {
  for (const WaitingMessage& message : stream.waiting) {
    if (message.packet_id != 0) redeliveries_.Drop(message.packet_id, message.number);
    for (const auto& [packet_id, number] : message.earlier) redeliveries_.Drop(packet_id, number);
    Count(metrics::Became::kRefused, std::nullopt);
  }
  stream.waiting.clear();
  // They come again before the dropped ones, and must be stored before them.
  redeliveries_.DropSettled(stream.id, std::exchange(stream.settled, {}));
  context_.probe.twins_lost.Add();
  fenced_ = true;
  context_.streams.Lose(stream);
}

}  // namespace uplink::broker
