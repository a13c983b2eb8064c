#include "server/session/outgoing.h"

#include "server/session/frames.h"

namespace uplink::session {

void Outgoing::Begin(const robot::Resume& resume) {
  Push(WelcomeFrame(robot_.robot().ruri(), resume.committed, context_.limits,
                    context_.clock.System()));
  PushRejects(resume.rejects);
  MakeAckDue();
  if (context_.forwards == nullptr || robot_.declines_forwards()) return;
  receiver_ = context_.forwards->Join(*robot_.robot().id(), robot_.self());
}

void Outgoing::PushRejects(std::span<const robot::RejectedSeq> rejects) {
  for (const robot::RejectedSeq& rejected : rejects) {
    Push(RejectFrame(rejected.seq, rejected.rejection, rejected.retry_after_ms));
  }
}

void Outgoing::AddProcessed(Intake::Processed processed) {
  for (v1::RelayResponse& frame : processed.frames) Push(std::move(frame));
  ack_.AddProcessed(processed);
}

void Outgoing::AddProgress() {
  const robot::Progress progress = robot_.TakeProgress();
  PushRejects(progress.rejects);
  ack_.AddProgress(progress);
}

std::optional<v1::RelayResponse> Outgoing::NextAck() {
  const robot::Progress progress = robot_.TakeProgress();
  ack_.AddReleased(progress.released);
  if (!progress.rejects.empty()) {
    PushRejects(progress.rejects);
    return std::nullopt;
  }
  return ack_.Release(progress);
}

void Outgoing::Flush() {
  if (write_under_way_) return;
  // Nothing waits before it, so every Reject that it covers has been written.
  if (frames_.empty() && ack_.due()) {
    if (const std::optional<v1::RelayResponse> ack = NextAck()) {
      write_under_way_ = true;
      return sink_.Write(*ack);
    }
  }
  if (frames_.empty()) return WriteForwards();
  const v1::RelayResponse frame = std::move(frames_.front());
  frames_.pop_front();
  write_under_way_ = true;
  sink_.Write(frame);
}

void Outgoing::WriteForwards() {
  if (receiver_ == nullptr) return;
  // A fast peer may take a long snapshot: other streams of the thread go in between.
  if (forwards_left_ == 0) return robot_.self().Wake();
  receiver_->Take(forwards_);
  if (forwards_.empty()) return;
  --forwards_left_;
  write_under_way_ = true;
  sink_.WriteEncoded(forwards_);
  forwards_.clear();
}

}  // namespace uplink::session
