#include "tools/uplink-fleet/robot/agent_model.h"

#include <algorithm>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

/// Encoded bytes that an Uplink adds beyond its payload: tags, lengths and a number.
constexpr std::size_t kUplinkOverheadBytes = 32;
/// Room for the frame's own fields.
constexpr std::size_t kFrameOverheadBytes = 64;

absl::Status Broken(const std::string& rule) {
  return absl::InternalError("the server broke a rule: " + rule);
}

}  // namespace

v1::Hello AgentModel::BeginStream(const std::string& agent_version) {
  phase_ = Phase::kGreeting;
  stream_ack_.Clear();
  v1::Hello hello;
  hello.set_session_id(std::string(session_.AsBytes()));
  hello.set_settled_seq(settled_seq_);
  hello.set_judged_seq(judged_seq_);
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  hello.set_agent_version(agent_version);
  hello.set_declines_forwards(declines_);
  return hello;
}

void AgentModel::EndStream() { phase_ = Phase::kClosed; }

absl::Status AgentModel::OnFrame(const v1::RelayResponse& frame, SteadyTime now) {
  if (phase_ == Phase::kClosed) return absl::OkStatus();
  if (frame.has_welcome() != (phase_ == Phase::kGreeting)) {
    return Broken("the first frame, and only the first, is a Welcome");
  }
  switch (frame.frame_case()) {
    case v1::RelayResponse::kWelcome:
      return OnWelcome(frame.welcome());
    case v1::RelayResponse::kAck:
      return OnAck(frame.ack());
    case v1::RelayResponse::kReject:
      return OnReject(frame.reject(), now);
    case v1::RelayResponse::kNotice:
      ++notices_;
      return absl::OkStatus();
    case v1::RelayResponse::kDrain:
      phase_ = Phase::kDraining;
      return absl::OkStatus();
    case v1::RelayResponse::kForward:
      // What it says is for who holds the table.
      return declines_ ? Broken("no Forward comes to an agent that declines them")
                       : absl::OkStatus();
    case v1::RelayResponse::kResendRequest:
      // What answers it is a message like any other, which the agent offers.
      return absl::OkStatus();
    case v1::RelayResponse::FRAME_NOT_SET:
      return Broken("a frame holds something");
  }
  return absl::OkStatus();
}

absl::Status AgentModel::OnWelcome(const v1::Welcome& welcome) {
  if (welcome.committed_seq() < settled_seq_) {
    return Broken(fmt::format("Welcome.committed_seq {} is below Hello.settled_seq {}",
                              welcome.committed_seq(), settled_seq_));
  }
  if (welcome.committed_seq() > last_seq()) {
    return Broken(fmt::format("Welcome.committed_seq {} was never sent; the last number is {}",
                              welcome.committed_seq(), last_seq()));
  }
  phase_ = Phase::kOpen;
  limits_ = welcome.limits();
  judged_seq_ = std::max(judged_seq_, welcome.committed_seq());
  resend_from_ = welcome.committed_seq() + 1;
  return absl::OkStatus();
}

absl::Status AgentModel::OnAck(const v1::Ack& ack) {
  if (ack.through_seq() < stream_ack_.through_seq() ||
      ack.judged_seq() < stream_ack_.judged_seq()) {
    return Broken(fmt::format("an Ack ({}, {}) came after ({}, {}) on the same stream",
                              ack.through_seq(), ack.judged_seq(), stream_ack_.through_seq(),
                              stream_ack_.judged_seq()));
  }
  if (std::max(ack.through_seq(), ack.judged_seq()) > last_seq()) {
    return Broken(fmt::format("an Ack ({}, {}) covers numbers that were never sent; the last is {}",
                              ack.through_seq(), ack.judged_seq(), last_seq()));
  }
  stream_ack_ = ack;
  settled_seq_ = std::max(settled_seq_, ack.through_seq());
  acked_judged_seq_ = std::max(acked_judged_seq_, ack.judged_seq());
  judged_seq_ = std::max(judged_seq_, ack.judged_seq());
  Forget();
  return absl::OkStatus();
}

absl::Status AgentModel::OnReject(const v1::Reject& reject, SteadyTime now) {
  if (reject.seq() <= settled_seq_ || reject.seq() > last_seq()) {
    return Broken(fmt::format("a Reject of {} came while {} to {} were unsettled", reject.seq(),
                              settled_seq_ + 1, last_seq()));
  }
  ++rejects_;
  judged_seq_ = std::max(judged_seq_, reject.seq());
  const auto at = kept_.find(reject.seq());
  if (at == kept_.end()) return absl::OkStatus();  // told once more after a Welcome
  if (reject.reason() != v1::REJECT_REASON_RATE_LIMITED) {
    at->second.rejection = model::Rejection{static_cast<model::RejectReason>(reject.reason()),
                                            reject.field(), reject.detail()};
    return absl::OkStatus();
  }
  // The number has ended: sent again under it, the content could be stored after all.
  Outgoing message = std::move(at->second.message);
  kept_.erase(at);
  if (message.keeping == Keeping::kDurable) {
    --durable_kept_;
    // An older one must not come after a newer one.
    if (NewerSent(reject.seq(), message.latest_of)) {
      send_queue_.Replace(message);
      return absl::OkStatus();
    }
    send_queue_.OfferLater(std::move(message),
                           now + milliseconds(std::max<std::int64_t>(reject.retry_after_ms(), 0)));
  } else {
    rate_limited_due_.push_back(message.due);
  }
  return absl::OkStatus();
}

bool AgentModel::NewerSent(model::Seq seq, const std::string& latest_of) const {
  if (latest_of.empty()) return false;
  return std::any_of(kept_.upper_bound(seq), kept_.end(), [&latest_of](const auto& kept) {
    return kept.second.message.latest_of == latest_of;
  });
}

void AgentModel::Forget() {
  const model::Seq highest = std::max(settled_seq_, acked_judged_seq_);
  for (auto it = kept_.begin(); it != kept_.end() && it->first <= highest;) {
    const bool durable = it->second.message.keeping == Keeping::kDurable;
    if (it->first > (durable ? settled_seq_ : acked_judged_seq_)) {
      ++it;
      continue;
    }
    if (durable) {
      --durable_kept_;
      settled_.push_back({it->first, it->second.message.tag, std::move(it->second.rejection),
                          it->second.message.due});
    } else {
      judged_due_.push_back(it->second.message.due);
    }
    it = kept_.erase(it);
  }
}

void AgentModel::Append(v1::UplinkBatch& batch, model::Seq seq, const Outgoing& message) {
  v1::Uplink* const uplink = batch.add_uplinks();
  uplink->set_seq(seq);
  switch (message.content) {
    case Content::kRoverNexus:
      uplink->set_rover_nexus(message.payload);
      break;
    case Content::kRcanRobotState:
      uplink->set_rcan_robot_state(message.payload);
      break;
    case Content::kNone:
      break;
  }
  ++sent_;
}

bool AgentModel::Fits(const v1::UplinkBatch& batch, std::size_t bytes, const Outgoing& message,
                      std::size_t uplinks_max) const {
  const auto count = static_cast<std::size_t>(batch.uplinks_size());
  if (count >= uplinks_max || count >= limits_.batch_uplinks_max()) return false;
  // A message too large for any frame goes alone, so that the server rejects it.
  return count == 0 ||
         bytes + message.payload.size() + kUplinkOverheadBytes + kFrameOverheadBytes <=
             limits_.frame_bytes_max();
}

std::optional<v1::UplinkBatch> AgentModel::NextBatch(SteadyTime now, std::size_t uplinks_max) {
  if (phase_ != Phase::kOpen) return std::nullopt;
  send_queue_.AdmitLater(now);
  v1::UplinkBatch batch;
  std::size_t bytes = 0;
  const auto grow = [&](model::Seq seq, const Outgoing& message) {
    bytes += message.payload.size() + kUplinkOverheadBytes;
    Append(batch, seq, message);
  };
  for (auto it = kept_.lower_bound(resend_from_); it != kept_.end(); ++it) {
    if (!Fits(batch, bytes, it->second.message, uplinks_max)) return batch;
    grow(it->first, it->second.message);
    ++resent_;
    resend_from_ = it->first + 1;
  }
  for (const Outgoing* next = send_queue_.Next();
       next != nullptr && kept_.size() < kKeptMax && Fits(batch, bytes, *next, uplinks_max);
       next = send_queue_.Next()) {
    const model::Seq seq = next_seq_++;
    Kept& kept = kept_[seq];
    kept.message = send_queue_.TakeNext();
    if (kept.message.keeping == Keeping::kDurable) ++durable_kept_;
    grow(seq, kept.message);
    resend_from_ = seq + 1;
  }
  if (batch.uplinks_size() == 0) return std::nullopt;
  return batch;
}

Unsent AgentModel::unsent() const {
  Unsent unsent = send_queue_.unsent();
  for (auto it = kept_.lower_bound(resend_from_); it != kept_.end(); ++it) {
    unsent.Add(1, it->second.message.due);
  }
  return unsent;
}

bool AgentModel::resending() const {
  return phase_ == Phase::kOpen && kept_.lower_bound(resend_from_) != kept_.end();
}

bool AgentModel::durable_settled() const {
  return durable_kept_ == 0 && !send_queue_.holds_durable();
}

bool AgentModel::all_settled() const { return kept_.empty() && send_queue_.empty(); }

std::vector<SteadyTime> AgentModel::TakeGaveWay() {
  std::vector<SteadyTime> due = send_queue_.TakeGaveWay();
  due.insert(due.end(), rate_limited_due_.begin(), rate_limited_due_.end());
  rate_limited_due_.clear();
  return due;
}

}  // namespace uplink::synthetic
