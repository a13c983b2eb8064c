// RCAN's Robot State: a live message whose order is the stream's.
#include <utility>

#include "schema/rcan/judge.h"
#include "server/session/intake.h"

namespace uplink::session {

void Intake::TakeRcan(const UplinkView& uplink, Taken& taken) {
  schema::RcanJudgement judgement =
      schema::JudgeRcanState(uplink.payload, id_->ruri, context_.limits.message_bytes_max);
  sign_of_life_ = sign_of_life_ || (judgement.sign_of_life && context_.limits.rcan_counts_as_life);
  if (const model::Rejection* rejection = judgement.rejection()) {
    return TakeRejected(uplink, *rejection, metrics::kRcanKind, taken);
  }
  if (rcan_order_ == nullptr) rcan_order_ = std::make_unique<RcanOrder>();
  auto& state = std::get<model::RcanState>(judgement.verdict);
  counts_.rcan_missing += rcan_order_->See(state);
  const RcanOrder::Place place = rcan_order_->PlaceOf(state);
  if (place == RcanOrder::Place::kOlder) {
    return TakeRejected(
        uplink,
        schema::NotMonotonic("timestamp_us", state.timestamp_us, rcan_order_->last_timestamp_us()),
        metrics::kRcanKind, taken);
  }
  ++counts_.rcan_states;
  NoteDropped(uplink.seq, judgement.dropped, metrics::kRcanKind, taken);
  unsettled_ = uplink.seq;
  if (place == RcanOrder::Place::kSame) {
    ++counts_.received;
    ++counts_.superseded;
    return;
  }
  rcan_order_->Take(state);
  std::optional<model::RcanState>& latest = context_.scratch.rcan;
  if (latest) {
    ++counts_.received;
    ++counts_.superseded;
  }
  latest = std::move(state);
}

}  // namespace uplink::session
