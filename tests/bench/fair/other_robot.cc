#include "tests/bench/fair/other_robot.h"

#include <utility>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/load/client.h"
#include "tests/bench/load/robots.h"

namespace uplink::bench {
namespace {

using synthetic::Keeping;

constexpr milliseconds kComesBackAfter{1'000};
/// A connection that brings no Welcome for so long is given up.
constexpr milliseconds kWelcomeWait{20'000};
/// Behind so many bytes a live message waits for a newer one in its place.
constexpr std::size_t kUnsentMax = std::size_t{64} * 1024;

double Milliseconds(SteadyTime::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

OtherRobot::OtherRobot(OthersWorld& world, link::Identity identity, std::size_t number)
    : world_(world), identity_(std::move(identity)), number_(number), agent_(NewSessionId()) {
  Connect();
}

void OtherRobot::Connect() {
  over_ = false;
  since_ = world_.clock.Steady();
  agent_.EndStream();
  link::LinkOptions options = world_.link;
  options.identity = identity_;
  connection_ = std::make_unique<link::GrpcConnection>(world_.loop, std::move(options),
                                                       static_cast<link::StreamEvents&>(*this));
  connection_->Connect();
}

void OtherRobot::Mend() {
  if (open()) return;
  const milliseconds wait = over_ ? kComesBackAfter : kWelcomeWait;
  if (world_.clock.Steady() - since_ >= wait) Connect();
}

void OtherRobot::OnConnected() {
  connection_->OpenStream(kRelayMethod);
  v1::RelayRequest frame;
  *frame.mutable_hello() = agent_.BeginStream("good robot");
  connection_->Send(frame.SerializeAsString());
}

void OtherRobot::Send(Keeping keeping, std::string payload) {
  const SteadyTime now = world_.clock.Steady();
  const bool taken = agent_.Offer(
      {.keeping = keeping, .payload = std::move(payload), .tag = world_.window, .due = now});
  if (taken && keeping == Keeping::kDurable && world_.window > 0) pending_.insert(now);
  Pump();
}

void OtherRobot::SendLive() {
  if (!open() || connection_->unsent() > kUnsentMax) return;
  Send(Keeping::kLive, Payload(number_ + agent_.last_seq()));
}

void OtherRobot::SendEvent() { Send(Keeping::kDurable, GoodEvent(++events_)); }

void OtherRobot::Pump() {
  v1::RelayRequest frame;
  while (auto batch = agent_.NextBatch(world_.clock.Steady(), 1)) {
    *frame.mutable_batch() = *std::move(batch);
    connection_->Send(frame.SerializeAsString());
  }
}

void OtherRobot::OnMessage(std::string_view message) {
  v1::RelayResponse frame;
  const SteadyTime now = world_.clock.Steady();
  if (!frame.ParseFromArray(message.data(), static_cast<int>(message.size())) ||
      !agent_.OnFrame(frame, now).ok()) {
    return connection_->CancelStream();
  }
  if (frame.has_reject() && world_.tally != nullptr) ++world_.tally->rejects;
  static_cast<void>(agent_.TakeJudged());
  static_cast<void>(agent_.TakeGaveWay());
  for (const synthetic::Settled& each : agent_.TakeSettled()) {
    if (world_.tally == nullptr || each.tag != world_.tallied_window) continue;
    world_.tally->ack_ms.push_back(Milliseconds(now - each.due));
    if (const auto at = pending_.find(each.due); at != pending_.end()) pending_.erase(at);
  }
  Pump();
}

void OtherRobot::OnEnded(const link::StreamEnd& /*end*/) {
  agent_.EndStream();
  over_ = true;
  since_ = world_.clock.Steady();
  if (world_.tally != nullptr) ++world_.tally->cut;
}

void OtherRobot::GiveUp() {
  const SteadyTime now = world_.clock.Steady();
  world_.tally->unacked += pending_.size();
  for (const SteadyTime sent : pending_) world_.tally->ack_ms.push_back(Milliseconds(now - sent));
  pending_.clear();
}

}  // namespace uplink::bench
