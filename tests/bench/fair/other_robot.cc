#include "tests/bench/fair/other_robot.h"

#include <algorithm>
#include <utility>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/load/client.h"
#include "tests/bench/load/session_id.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kComesBackAfter{1'000};
/// A connection that brings no Welcome for so long is given up.
constexpr milliseconds kWelcomeWait{20'000};
/// Durable messages that are kept: more than any run sends.
constexpr std::size_t kPendingMax = 4096;
/// Behind so many bytes a live message waits for a newer one in its place.
constexpr std::size_t kUnsentMax = std::size_t{64} * 1024;

double Milliseconds(SteadyTime::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

OtherRobot::OtherRobot(OthersWorld& world, link::Identity identity, std::size_t number)
    : world_(world), identity_(std::move(identity)), number_(number), session_(NewSessionId()) {
  Connect();
}

void OtherRobot::Connect() {
  over_ = false;
  since_ = world_.clock.Steady();
  link::LinkOptions options = world_.link;
  options.identity = identity_;
  connection_ = std::make_unique<link::GrpcConnection>(world_.loop, std::move(options),
                                                       static_cast<link::StreamEvents&>(*this));
  connection_->Connect();
}

void OtherRobot::Mend() {
  if (open_) return;
  const milliseconds wait = over_ ? kComesBackAfter : kWelcomeWait;
  if (world_.clock.Steady() - since_ >= wait) Connect();
}

void OtherRobot::OnConnected() {
  connection_->OpenStream("/uplink.v1.UplinkRelay/Relay");
  v1::RelayRequest frame;
  v1::Hello& hello = *frame.mutable_hello();
  hello.set_session_id(session_);
  hello.set_settled_seq(settled_seq_);
  hello.set_judged_seq(judged_seq_);
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  hello.set_agent_version("good robot");
  hello.set_declines_forwards(true);
  connection_->Send(frame.SerializeAsString());
}

void OtherRobot::SendOne(std::uint64_t seq, const std::string& payload) {
  v1::UplinkBatch& batch = *frame_.mutable_batch();
  batch.clear_uplinks();
  v1::Uplink& uplink = *batch.add_uplinks();
  uplink.set_seq(seq);
  uplink.set_rover_nexus(payload);
  connection_->Send(frame_.SerializeAsString());
}

void OtherRobot::SendLive() {
  if (!open_ || connection_->unsent() > kUnsentMax) return;
  ++last_seq_;
  SendOne(last_seq_, Payload(number_ + last_seq_));
}

void OtherRobot::SendEvent() {
  if (pending_.size() >= kPendingMax) return;
  ++last_seq_;
  pending_.push_back({last_seq_, world_.clock.Steady(), world_.window});
  if (open_) SendOne(last_seq_, GoodEvent(last_seq_));
}

void OtherRobot::OnMessage(std::string_view message) {
  v1::RelayResponse frame;
  if (!frame.ParseFromArray(message.data(), static_cast<int>(message.size()))) return;
  if (frame.has_welcome()) OnWelcome(frame.welcome());
  if (frame.has_ack()) OnAck(frame.ack());
  if (frame.has_reject() && world_.tally != nullptr) ++world_.tally->rejects;
}

void OtherRobot::OnWelcome(const v1::Welcome& welcome) {
  judged_seq_ = std::max(judged_seq_, welcome.committed_seq());
  open_ = true;
  for (const Pending& each : pending_) {
    if (each.seq > welcome.committed_seq()) SendOne(each.seq, GoodEvent(each.seq));
  }
}

void OtherRobot::OnAck(const v1::Ack& ack) {
  settled_seq_ = std::max(settled_seq_, ack.through_seq());
  judged_seq_ = std::max({judged_seq_, settled_seq_, ack.judged_seq()});
  const SteadyTime now = world_.clock.Steady();
  for (; !pending_.empty() && pending_.front().seq <= settled_seq_; pending_.pop_front()) {
    const Pending& each = pending_.front();
    if (world_.tally != nullptr && each.window == world_.tallied_window) {
      world_.tally->ack_ms.push_back(Milliseconds(now - each.sent));
    }
  }
}

void OtherRobot::OnEnded(const link::StreamEnd& /*end*/) {
  open_ = false;
  over_ = true;
  since_ = world_.clock.Steady();
  if (world_.tally != nullptr) ++world_.tally->cut;
}

bool OtherRobot::HasPending(std::uint64_t window) const {
  return std::ranges::any_of(pending_, [&](const Pending& each) { return each.window == window; });
}

void OtherRobot::GiveUp(std::uint64_t window, OthersTally& tally) {
  const SteadyTime now = world_.clock.Steady();
  for (const Pending& each : pending_) {
    if (each.window != window) continue;
    ++tally.unacked;
    tally.ack_ms.push_back(Milliseconds(now - each.sent));
  }
}

}  // namespace uplink::bench
