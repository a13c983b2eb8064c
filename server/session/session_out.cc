// What a session sends: Rejects, then the Acks that may cover them; and its timers.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/session/frames.h"
#include "server/session/session.h"

namespace uplink::session {

void Session::TakeProgress() {
  robot::Progress progress = robot_->sessions.Take(hello_.session);
  for (const robot::RejectedSeq& rejected : progress.rejects) {
    outgoing_.push_back(RejectFrame(rejected.seq, rejected.rejection));
  }
  NoteReleased(progress.released);
  if (progress.through > acked_through_) ack_due_ = true;
}

void Session::NoteReleased(const std::vector<SteadyTime>& released) {
  // Arrivals are for a histogram alone: past the bound the peer does not read, and they are let go.
  const std::size_t room = kReleasedMax - std::min(kReleasedMax, released_.size());
  const auto count = static_cast<std::ptrdiff_t>(std::min(room, released.size()));
  released_.insert(released_.end(), released.begin(), released.begin() + count);
}

std::optional<v1::RelayResponse> Session::NextAck() {
  // Nothing waits in front of it, so every Reject that it may cover has been written.
  const std::size_t before = outgoing_.size();
  robot::Progress progress = robot_->sessions.Take(hello_.session);
  NoteReleased(progress.released);
  for (const robot::RejectedSeq& rejected : progress.rejects) {
    outgoing_.push_back(RejectFrame(rejected.seq, rejected.rejection));
  }
  if (outgoing_.size() > before) return std::nullopt;
  acked_through_ = std::max(acked_through_, progress.through);
  acked_judged_ = std::max(acked_judged_, progress.judged);
  ack_due_ = false;
  ack_at_.reset();
  unacked_messages_ = 0;
  const SteadyTime now = context_.clock.Steady();
  for (const SteadyTime arrived : released_) {
    context_.probe.ack_seconds.Observe(std::chrono::duration<double>(now - arrived).count());
  }
  released_.clear();
  context_.probe.acks_total.Add();
  return AckFrame(acked_through_, acked_judged_);
}

bool Session::WriteNext() {
  if (outgoing_.empty() && ack_due_) {
    if (std::optional<v1::RelayResponse> ack = NextAck()) {
      write_under_way_ = true;
      sink_.Write(*ack);
      return true;
    }
  }
  if (outgoing_.empty()) return false;
  const v1::RelayResponse frame = std::move(outgoing_.front());
  outgoing_.pop_front();
  write_under_way_ = true;
  sink_.Write(frame);
  return true;
}

void Session::Flush() {
  if (state_ == State::kDone || write_under_way_) return;
  WriteNext();
}

void Session::OnTimer() {
  if (state_ == State::kDone) return;
  const SteadyTime now = context_.clock.Steady();
  if (hello_until_ && now >= *hello_until_) {
    frames_ = 1;
    return ProtocolError(fmt::format("no hello within {} s", kHelloWait.count()));
  }
  if (state_ == State::kOpening && welcome_at_ && now >= *welcome_at_) return SendWelcome();
  if (settle_until_ && now >= *settle_until_) {
    return Finish(absl::UnavailableError("not all was settled within drain.timeout"));
  }
  if (stalled_at_ && now >= *stalled_at_) {
    context_.probe.peer_stalls_total.Add();
    Finish(absl::ResourceExhaustedError(
        fmt::format("the agent read nothing for {} s while {} frames waited for it",
                    kPeerStallMax.count(), outgoing_.size())));
    return sink_.Cancel();
  }
  if (ack_at_ && now >= *ack_at_) {
    ack_at_.reset();
    ack_due_ = true;
  }
  if (intake_ != nullptr && intake_->pending()) TakePending();
  Flush();
  EndWhenSettled();
  Read();
}

std::optional<SteadyTime> Session::deadline() const {
  if (state_ == State::kDone) return std::nullopt;
  std::optional<SteadyTime> first;
  const auto consider = [&first](const std::optional<SteadyTime>& at) {
    if (at && (!first || *at < *first)) first = at;
  };
  consider(ack_at_);
  consider(welcome_at_);
  consider(stalled_at_);
  consider(settle_until_);
  consider(read_again_at_);
  consider(hello_until_);
  return first;
}

}  // namespace uplink::session
