#include "tests/simulation/sim_agent.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace uplink::simulation {

std::size_t SimAgent::SessionsWithKept() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      sessions_, [](const AgentSession& session) { return !session.kept.empty(); }));
}

void SimAgent::NewSession(Random& random) {
  AgentSession session;
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.Next());
  session.id = model::SessionId(bytes);
  sessions_.push_back(std::move(session));
}

v1::RelayRequest SimAgent::Connect(Random& random) {
  if (sessions_.empty()) NewSession(random);
  session_ = &sessions_.back();
  for (AgentSession& session : sessions_) {
    if (session.kept.empty()) continue;
    session_ = &session;
    break;
  }
  welcomed_ = false;
  resend_.clear();
  stream_through_ = 0;
  stream_judged_ = 0;
  unrejected_.clear();
  // Nothing at or below Welcome.committed_seq need be sent again, and it may be.
  resends_all_ = random.Percent(30);
  v1::RelayRequest request;
  v1::Hello& hello = *request.mutable_hello();
  hello.set_session_id(std::string(session_->id.AsBytes()));
  hello.set_settled_seq(session_->settled);
  hello.set_judged_seq(std::max(session_->judged, session_->settled));
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  hello.set_declines_forwards(self_.declines_forwards);
  table_.OnStream();
  return request;
}

void SimAgent::AddUplink(v1::UplinkBatch& batch, model::Seq seq, Content content) const {
  v1::Uplink& uplink = *batch.add_uplinks();
  uplink.set_seq(seq);
  if (content != Content::kEmpty) uplink.set_rover_nexus(payloads_.Of(content));
}

Content SimAgent::NextContent(Random& random) const {
  static constexpr std::array<Content, 26> kMix = {
      Content::kFault,   Content::kFault,   Content::kFault,   Content::kEvent,
      Content::kEvent,   Content::kMotion,  Content::kMotion,  Content::kMotion,
      Content::kMotion,  Content::kMotion,  Content::kMotion,  Content::kRefused,
      Content::kBadLive, Content::kBadLive, Content::kBadLive, Content::kBadDurable,
      Content::kEmpty,   Content::kSpatial, Content::kSpatial, Content::kSpatial,
      Content::kSpatial, Content::kSpatial, Content::kSpatial, Content::kSpatial,
      Content::kSpatial, Content::kSpatial};
  const Content content = floods_ ? Content::kSpatial : kMix[random.Below(kMix.size())];
  if (content != Content::kSpatial) return content;
  const std::size_t item = random.Below(kSpatialItems);
  // Most are shared for good, or none would be there to be lost.
  static constexpr std::array<Spatial, 3> kLasting = {Spatial::kForFleet, Spatial::kForFleetMoved,
                                                      Spatial::kForWorld};
  const Spatial spatial = random.Percent(60) ? kLasting[random.Below(kLasting.size())]
                                             : static_cast<Spatial>(random.Below(kSpatialKinds));
  return SpatialOf(item, spatial);
}

v1::RelayRequest SimAgent::Batch(Random& random, std::size_t messages_max, Fresh fresh) {
  v1::RelayRequest request;
  v1::UplinkBatch& batch = *request.mutable_batch();
  for (std::size_t i = 0; i < messages_max; ++i) {
    if (!resend_.empty()) {
      AddUplink(batch, resend_.front(), session_->kept.at(resend_.front()));
      resend_.pop_front();
      continue;
    }
    if (HasLimited() && (fresh == Fresh::kNo || random.Percent(30))) {
      AddFresh(batch, limited_.begin()->second);
      continue;
    }
    if (fresh == Fresh::kNo) break;
    if (random.Percent(5)) session_->next += 1 + random.Below(3);
    AddFresh(batch, greedy_ ? Content::kLarge : NextContent(random));
  }
  return request;
}

void SimAgent::AddFresh(v1::UplinkBatch& batch, Content content) {
  const model::Seq seq = session_->next++;
  AddUplink(batch, seq, content);
  if (RejectedAtJudgement(content)) unrejected_.insert(seq);
  if (content >= Content::kSpatial) {
    newest_[ItemOf(content)] = {session_->id, seq};
    limited_.erase(ItemOf(content));
  }
  if (!KeptUntilSettled(content)) return;
  session_->kept.emplace(seq, content);
  if (!MayExpire(content)) session_->durable_sent.insert(seq);
}

void SimAgent::OnStoreWentBack() {
  for (AgentSession& session : sessions_) {
    const DurableSession& durable = recorder_.Of(ruri(), session.id);
    std::erase_if(session.durable_sent, [&](model::Seq seq) {
      return !session.kept.contains(seq) && !durable.Holds(seq);
    });
  }
}

void SimAgent::OnFrame(const v1::RelayResponse& frame) {
  if (session_ == nullptr) return;
  switch (frame.frame_case()) {
    case v1::RelayResponse::kWelcome:
      return OnWelcome(frame.welcome());
    case v1::RelayResponse::kAck:
      return OnAck(frame.ack());
    case v1::RelayResponse::kReject:
      return OnReject(frame.reject());
    case v1::RelayResponse::kForward:
      return OnForward(frame.forward());
    default:
      return;
  }
}

void SimAgent::OnReject(const v1::Reject& reject) {
  if (!welcomed_) violation_("a Reject came before Welcome");
  session_->told.insert(reject.seq());
  unrejected_.erase(reject.seq());
  session_->judged = std::max(session_->judged, reject.seq());
  if (reject.reason() != v1::REJECT_REASON_RATE_LIMITED) return;
  if (session_->limited.insert(reject.seq()).second) OnLimited(reject.seq());
}

void SimAgent::OnLimited(model::Seq seq) {
  if (!may_be_limited_) violation_("a message was rejected for a rate that there is not");
  session_->durable_sent.erase(seq);
  const auto kept = session_->kept.find(seq);
  if (kept == session_->kept.end() || kept->second < Content::kSpatial) {
    return violation_(fmt::format("number {} has no rate, or was acked before its Reject", seq));
  }
  const std::size_t item = ItemOf(kept->second);
  if (newest_[item] == std::pair(session_->id, seq)) limited_[item] = kept->second;
}

void SimAgent::OnForward(const v1::Forward& forward) {
  if (!welcomed_) violation_("a Forward came before Welcome");
  if (self_.declines_forwards) return violation_("a Forward came that was declined");
  table_.OnForward(forward);
}

void SimAgent::OnWelcome(const v1::Welcome& welcome) {
  if (welcomed_) violation_("two Welcomes on one stream");
  welcomed_ = true;
  if (welcome.committed_seq() < session_->settled) {
    violation_("Welcome.committed_seq is below Hello.settled_seq");
  }
  session_->judged = std::max(session_->judged, welcome.committed_seq());
  for (const auto& [seq, content] : session_->kept) {
    if (seq <= welcome.committed_seq()) CheckDurable(seq, content, When::kWelcome);
    if (seq > welcome.committed_seq() || resends_all_) resend_.push_back(seq);
  }
}

void SimAgent::OnAck(const v1::Ack& ack) {
  if (!welcomed_) violation_("an Ack came before Welcome");
  if (ack.through_seq() < stream_through_ || ack.judged_seq() < stream_judged_) {
    violation_("an Ack went back within its stream");
  }
  if (ack.through_seq() > ack.judged_seq()) violation_("Ack.through_seq is above judged_seq");
  if (ack.judged_seq() >= session_->next) violation_("an Ack names a number that was never used");
  CheckRejected(ack.judged_seq());
  stream_through_ = ack.through_seq();
  stream_judged_ = ack.judged_seq();
  session_->settled = std::max(session_->settled, ack.through_seq());
  session_->judged = std::max(session_->judged, ack.judged_seq());
  while (!session_->kept.empty() && session_->kept.begin()->first <= ack.through_seq()) {
    const auto [seq, content] = *session_->kept.begin();
    CheckDurable(seq, content, When::kAck);
    const DurableSession& durable = recorder_.Of(ruri(), session_->id);
    // What was rejected first may have expired when it came again: it is superseded then.
    if (durable.quarantined.contains(seq) && !session_->told.contains(seq) && !MayExpire(content)) {
      violation_(fmt::format("number {} is acked, in quarantine, and no Reject was told", seq));
    }
    session_->kept.erase(session_->kept.begin());
  }
  // What was settled need not be sent again, even where it waited to be.
  while (!resend_.empty() && resend_.front() <= ack.through_seq()) resend_.pop_front();
}

void SimAgent::CheckRejected(model::Seq judged) {
  if (unrejected_.empty() || *unrejected_.begin() > judged) return;
  violation_(fmt::format("number {} is bad and judged, and no Reject came before the Ack",
                         *unrejected_.begin()));
}

void SimAgent::CheckDurable(model::Seq seq, Content content, When when) {
  if (MayExpire(content) || recorder_.MayBeTold(ruri(), session_->id, seq)) return;
  if (!may_be_limited_ || content < Content::kSpatial) {
    return violation_(
        fmt::format("number {} is {} and the store has it not", seq,
                    when == When::kAck ? "acked" : "at or below Welcome.committed_seq"));
  }
  // Its Reject comes between Welcome and the Ack.
  if (when == When::kWelcome || session_->limited.contains(seq)) return;
  violation_(fmt::format("number {} is acked, the store has it not, and no Reject was told", seq));
}

}  // namespace uplink::simulation
