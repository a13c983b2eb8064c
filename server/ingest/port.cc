#include "server/ingest/port.h"

#include <string>
#include <utility>

namespace uplink::ingest {

Port::Offered Port::Offer(const Line& line, Message& message) {
  FollowReload();
  // It needs room for what it may bring. Without, it waits, or costs its own sender alone.
  if (const std::optional<RecordCost> cost = message.Cost()) {
    const Block block = FindBlock(line, message.arrival().waits, *cost);
    if (!block.none()) return HandleNoRoom(message, block);
  }
  message.Begin();
  // Its sender may send so many a second.
  if (const std::optional<model::Rejection> limited = message.TakeRate()) {
    RejectLimited(message, *limited);
    return {.answer = Answer::kLimited};
  }
  // What is bad goes to quarantine; what is good is held, stored, or both.
  if (const model::Rejection* rejection = message.FindRejection()) {
    Reject(line, message, *rejection);
  } else {
    Brought brought = message.Take();
    CountAge(message.arrival(), brought);
    Store(line, message, std::move(brought), std::nullopt);
  }
  return {};
}

Port::Offered Port::HandleNoRoom(Message& message, const Block& block) {
  if (block.is_excess) {
    message.Begin();
    RejectLimited(message,
                  {.reason = model::RejectReason::kRateLimited, .field = {}, .detail = {}});
    return {.answer = Answer::kLimited, .block = block};
  }
  if (message.arrival().waits != Waits::kNoOne) return {.answer = Answer::kWaits, .block = block};
  Count(message.arrival(), metrics::Became::kRefused);
  message.Settle(metrics::Became::kRefused);
  return {.answer = Answer::kRefused, .block = block};
}

void Port::RejectLimited(Message& message, const model::Rejection& rejection) {
  switch (message.RejectLimited(rejection)) {
    case Numbered::kWaiting:
      CountOnce(message.arrival());
      ++counts_.in_flight;
      return;
    case Numbered::kLost:
      return Count(message.arrival(), context_.lost_counts_as);
    case Numbered::kSettled:
      break;
  }
  ++counts_.rejects[static_cast<std::size_t>(rejection.reason)];
  Count(message.arrival(), metrics::Became::kRejected);
}

void Port::Reject(const Line& line, Message& message, const model::Rejection& rejection) {
  const Arrival& arrival = message.arrival();
  const Quarantined row = message.Reject(rejection);
  storage::CommitRecord record{.received_at = arrival.system,
                               .content = storage::QuarantineItem{.rejection = rejection},
                               .payload = {},
                               .payload_bytes = arrival.payload_bytes};
  if (row.payload_may_be_kept && !line.robot.flow.disk_limits() &&
      line.robot.sessions.KeepPayload(rejection.reason, arrival.steady)) {
    record.payload = arrival.payload.substr(0, context_.payload_bytes_max);
    line.robot.flow.CountKept(record.payload.size());
  }
  Brought brought{.records = {}, .flow_bytes = row.flow_bytes};
  brought.records.push_back(std::move(record));
  Store(line, message, std::move(brought), rejection.reason);
}

void Port::Store(const Line& line, Message& message, Brought brought,
                 std::optional<model::RejectReason> rejected) {
  const Arrival& arrival = message.arrival();
  if (brought.records.empty()) {
    if (!brought.became) return;
    Count(arrival, *brought.became);
    return message.Settle(*brought.became);
  }
  for (std::size_t i = 0; i < brought.records.size(); ++i) {
    // The bytes are those of the message, the first record's.
    TakeFlow(line, arrival.waits,
             brought.flow_bytes && i > 0 ? std::optional<std::size_t>(0) : brought.flow_bytes);
  }
  for (storage::CommitRecord& record : brought.records) {
    record.robot = line.id;
    record.session = line.session;
  }
  if (message.Number(brought.records, rejected) == Numbered::kLost) {
    return Count(arrival, context_.lost_counts_as);
  }
  CountOnce(arrival);
  ++counts_.in_flight;
  Append(line, std::move(brought.records), arrival.steady);
}

void Port::Append(const Line& line, std::vector<storage::CommitRecord> records,
                  SteadyTime arrived) {
  // Before the writer can settle them, so that no scrape sees them settled and not received.
  Publish();
  line.robot.traffic.CountRows(records.size());
  line.journal.AppendMessage(line.appends_for(), line.by, std::move(records), arrived);
}

void Port::TakeFlow(const Line& line, Waits waits, std::optional<std::size_t> bytes) {
  if (!bytes) return;
  const SteadyTime now = context_.clock.Steady();
  robot::DurableFlow& flow = line.robot.flow;
  // A message that passes beyond its robot's flow leaves no debt there.
  if (waits == Waits::kStream || flow.LookAt(*bytes, allowance().flow, now).by == HeldBack::kNone) {
    flow.Take(*bytes, allowance().flow, now);
  } else {
    flow.CountKept(*bytes);
  }
}

void Port::NoteLife(const Line& line, SteadyTime steady, SystemTime system) {
  line.robot.state.SignOfLife(steady, system, context_.fleet.presence_limits_of(line.robot));
}

Block Port::FindBlock(const Line& line, Waits waits, const RecordCost& cost) {
  return ingest::FindBlock(
      line, waits, cost,
      {.clock = context_.clock,
       .flow = allowance().flow,
       .in_flight_max = context_.in_flight_max,
       .journal_over_half = waits == Waits::kBroker && context_.journal_over_half()});
}

void Port::CountAge(const Arrival& arrival, const Brought& brought) {
  if (arrival.sampled_unix_ms <= 0) return;
  // A command of a broker, or a message of none of its robots, reports nothing.
  if (brought.became == metrics::Became::kObserved || brought.became == metrics::Became::kIgnored) {
    return;
  }
  const auto kind = brought.records.empty() ? metrics::AgeKind::kLive : metrics::AgeKind::kDurable;
  ages_[static_cast<std::size_t>(kind)].Add(
      milliseconds(UnixMs(arrival.system) - arrival.sampled_unix_ms));
}

void Port::CountOnce(const Arrival& arrival) {
  if (arrival.is_counted) {
    --counts_.in_flight;
  } else {
    ++counts_.received;
  }
}

void Port::Count(const Arrival& arrival, metrics::Became became) {
  CountOnce(arrival);
  counts_.Count(became);
}

void Port::CountHeld() {
  ++counts_.received;
  ++counts_.in_flight;
}

void Port::Publish() {
  context_.ledger.Publish(counts_, ages_);
  counts_ = {};
  ages_ = {};
}

void Port::FollowReload() {
  if (allowance_version_ == context_.allowances.version()) return;
  allowance_version_ = context_.allowances.version();
  allowance_ = context_.allowances.Get();
}

}  // namespace uplink::ingest
