// How a stream ends: half-closed, drained, broken, at fault.
#include <algorithm>

#include "server/session/frames.h"
#include "server/session/session.h"

namespace uplink::session {

void Session::OnHalfClose() {
  read_under_way_ = false;
  if (state_ == State::kHello) {
    ++frames_;
    return ProtocolError("the stream was half-closed before a hello");
  }
  if (state_ != State::kStreaming) return;
  state_ = State::kSettling;
  end_status_ = absl::OkStatus();
  settle_until_ = context_.clock.Steady() + context_.limits.drain_timeout;
  SetHeldBack(false);
  EndWhenSettled();
}

void Session::OnDrain(milliseconds grace) {
  const absl::Status drained = absl::UnavailableError("the server drains");
  if (state_ == State::kDone) return;
  if (state_ != State::kStreaming && state_ != State::kSettling) return Finish(drained);
  outgoing_.push_back(DrainFrame(grace));
  if (state_ == State::kStreaming) {
    // What was not judged yet was not taken: the agent sends it again.
    intake_->Drop();
    state_ = State::kSettling;
    end_status_ = drained;
    // It is we who do not listen any more, so the robot must not become offline.
    SetHeldBack(true);
  }
  const SteadyTime until = context_.clock.Steady() + grace;
  settle_until_ = settle_until_ ? std::min(*settle_until_, until) : until;
  Flush();
  EndWhenSettled();
}

void Session::EndWhenSettled() {
  if (state_ != State::kSettling || intake_->pending()) return;
  if (robot_->sessions.waiting(hello_.session) > 0) return;
  // Another process took the robot, and what waited with it: the wake that is on its way ends this.
  if (robot_->sessions.PlaceOf(self_) == robot::StreamPlace::kSuperseded) return;
  if (!last_ack_queued_) {
    last_ack_queued_ = true;
    ack_due_ = true;
    Flush();
  }
  if (!write_under_way_ && outgoing_.empty() && !ack_due_) Finish(end_status_);
}

void Session::OnBroken() {
  if (state_ == State::kDone) return;
  context_.probe.ended_total[kStreamBroken].Add();
  Leave();
}

void Session::Finish(const absl::Status& status) {
  if (state_ == State::kDone) return;
  const auto code = static_cast<std::size_t>(status.code());
  context_.probe.ended_total[std::min(code, kStreamBroken - 1)].Add();
  Leave();
  sink_.Finish(status);
}

void Session::Leave() {
  if (state_ == State::kDone) return;
  state_ = State::kDone;
  if (robot_ == nullptr) return;
  SetHeldBack(false);
  robot_->sessions.Detach(self_, context_.clock.Steady()).Wake();
}

}  // namespace uplink::session
