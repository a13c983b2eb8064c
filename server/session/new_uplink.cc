#include "server/session/new_uplink.h"

#include <string>
#include <utility>
#include <variant>

#include "schema/rcan/judge.h"
#include "server/robot/mutation.h"
#include "server/session/frames.h"

namespace uplink::session {

using ingest::Numbered;

namespace {

std::int64_t SampledUnixMs(const Judged& judged) {
  constexpr std::int64_t kUsPerMs = 1000;
  if (const auto* record = std::get_if<model::Record>(&judged.content)) {
    return model::SampledUnixMs(record->body());
  }
  const auto* state = std::get_if<model::RcanState>(&judged.content);
  return state == nullptr ? 0 : state->timestamp_us / kUsPerMs;
}

}  // namespace

NewUplink::NewUplink(const UplinkSources& sources, const UplinkView& uplink, const Arrived& arrived,
                     const robot::Seen& seen, Judged& judged, Processed& processed)
    : sources_(sources),
      uplink_(uplink),
      arrival_{.steady = arrived.steady,
               .system = arrived.system,
               .payload = uplink.payload,
               .payload_bytes = uplink.payload.size(),
               .waits = ingest::Waits::kStream,
               .sampled_unix_ms = SampledUnixMs(judged)},
      seen_(seen),
      judged_(judged),
      processed_(processed) {}

bool NewUplink::IsNew() const { return uplink_.seq > sources_.robot.sessions.free_through(); }

const model::Record* NewUplink::Durable() const {
  const auto* record = std::get_if<model::Record>(&judged_.content);
  return record != nullptr && record->durable() && !judged_.expired ? record : nullptr;
}

std::optional<ingest::RecordCost> NewUplink::Cost() {
  const std::size_t payload = uplink_.payload.size();
  cost_ = sources_.ranges.CostOfGap(seen_);
  if (const model::Record* record = Durable()) {
    const ingest::Allowance& allowance = sources_.port.allowance();
    if (IsNew() && sources_.robot.rates.WouldLimit(record->body(), allowance.rates,
                                                   sources_.context.clock.Steady())) {
      // Counts as a gap; a number that continues a range takes no flow, and is in flight like any
      // other.
      cost_.journal_bytes += robot::kRecordOverheadBytes;
      if (!sources_.ranges.Continues(uplink_.seq)) cost_.flow_bytes = 0;
    } else {
      cost_.journal_bytes += journal::CostOf(payload, *record);
      if (IsNew()) cost_.flow_bytes = ingest::FlowBytes(payload, *record);
    }
  } else if (const auto* rejection = std::get_if<model::Rejection>(&judged_.content)) {
    cost_.journal_bytes += journal::CostOf(payload, *rejection);
  } else if (const auto* state = std::get_if<model::RcanState>(&judged_.content);
             state != nullptr && sources_.live.AgeOf(*state) == RcanOrder::Age::kOlder) {
    cost_.journal_bytes += journal::CostOf(payload, model::Rejection());
  }
  return cost_.journal_bytes > 0 ? std::optional(cost_) : std::nullopt;
}

void NewUplink::Begin() {
  sources_.ranges.AddGap(seen_);
  sources_.live.TakeRate(judged_.kind, sources_.port.allowance().telemetry);
  if (judged_.sign_of_life) sources_.live.NoteLife();
  if (judged_.odd.any()) sources_.context.ledger.CountOdd(judged_.odd);
}

std::optional<model::Rejection> NewUplink::TakeRate() {
  const auto* record = std::get_if<model::Record>(&judged_.content);
  // An expired upsert is superseded, at any rate.
  if (record == nullptr || judged_.expired) return std::nullopt;
  const robot::RateTable& rates = sources_.port.allowance().rates;
  const limits::BucketSize& rate = rates[static_cast<std::size_t>(record->variant())];
  if (rate.rate == 0 || !IsNew()) return std::nullopt;
  const std::optional<milliseconds> again =
      sources_.robot.rates.Limit(record->body(), rates, sources_.context.clock.Steady());
  if (!again) return std::nullopt;
  again_ = *again;
  return robot::RateLimited(rate);
}

Numbered NewUplink::RejectLimited(const model::Rejection& rejection) {
  auto& record = std::get<model::Record>(judged_.content);
  ++processed_.costly;
  sources_.robot.limited_throttle.Add(sources_.context.clock.Steady());
  sources_.context.ledger.CountRejected(static_cast<std::size_t>(record.variant()),
                                        rejection.reason);
  processed_.frames.push_back(RejectFrame(uplink_.seq, rejection, again_.count()));
  const bool is_stored = record.durable() && !robot::Planted(robot::Mutation::kLimitedNotStored);
  sources_.context.judge.Reuse(std::move(record));
  robot::RejectedSeq limited{
      .seq = uplink_.seq, .rejection = rejection, .retry_after_ms = again_.count()};
  if (is_stored) return sources_.ranges.AddLimited(std::move(limited));
  sources_.robot.sessions.RememberLive(sources_.session, std::move(limited));
  sources_.numbers.AddSettled(uplink_.seq);
  return Numbered::kSettled;
}

const model::Rejection* NewUplink::FindRejection() {
  if (const auto* state = std::get_if<model::RcanState>(&judged_.content)) {
    age_ = sources_.live.See(*state);
    if (age_ != RcanOrder::Age::kOlder) return nullptr;
    too_old_ = schema::NotMonotonic("timestamp_us", state->timestamp_us,
                                    sources_.live.last_timestamp_us());
    return &*too_old_;
  }
  return std::get_if<model::Rejection>(&judged_.content);
}

ingest::Quarantined NewUplink::Reject(const model::Rejection& rejection) {
  // Now, not the frame's arrival: a large frame may be processed over several seconds.
  sources_.robot.throttle.Add(sources_.context.clock.Steady());
  ++processed_.costly;
  sources_.context.ledger.CountRejected(judged_.kind, rejection.reason);
  processed_.frames.push_back(RejectFrame(uplink_.seq, rejection));
  sources_.robot.sessions.Remember(sources_.session, {.seq = uplink_.seq, .rejection = rejection});
  // The throttle bounds it, so that the flow need not.
  return {.payload_may_be_kept = true};
}

ingest::Brought NewUplink::Take() {
  if (auto* record = std::get_if<model::Record>(&judged_.content)) return TakeRecord(*record);
  sources_.numbers.AddSettled(uplink_.seq);
  sources_.live.Add(uplink_.seq, std::move(judged_), age_, processed_);
  return {};
}

ingest::Brought NewUplink::TakeRecord(model::Record& record) {
  ++sources_.port.counts().records[static_cast<std::size_t>(record.variant())];
  if (!record.durable()) {
    sources_.numbers.AddSettled(uplink_.seq);
    sources_.live.Add(uplink_.seq, std::move(record), processed_);
    return {};
  }
  if (judged_.expired) {
    sources_.numbers.AddSettled(uplink_.seq);
    return {.records = {}, .became = metrics::Became::kSuperseded};
  }
  ingest::Brought brought;
  if (IsNew()) brought.flow_bytes = ingest::FlowBytes(arrival_.payload_bytes, record);
  sources_.robot.state.KeepReport(record.body(), arrival_.system);
  latest_ = storage::LatestKindOf(record.variant());
  brought.records.push_back({.received_at = arrival_.system,
                             .content = std::move(record),
                             .payload = std::string(arrival_.payload),
                             .payload_bytes = arrival_.payload_bytes});
  return brought;
}

Numbered NewUplink::Number(std::vector<storage::CommitRecord>& records,
                           std::optional<model::RejectReason> /*rejected*/) {
  sources_.ranges.Flush();
  storage::CommitRecord& record = records.front();
  record.seq = uplink_.seq;
  const std::int64_t grew = sources_.numbers.AddWaiting(record.seq, journal::CostOf(record));
  // After it waits, so that an answer of the store that comes now counts it.
  if (latest_) sources_.robot.sessions.AddLatest(sources_.session, uplink_.seq, *latest_);
  return grew > 0 ? Numbered::kWaiting : Numbered::kLost;
}

}  // namespace uplink::session
