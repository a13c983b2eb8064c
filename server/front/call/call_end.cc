// How a call ends: by its handler, by its peer, by its connection, or when its time is over.
#include <algorithm>
#include <utility>

#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"
#include "server/front/call/call.h"
#include "server/front/call/grpc_status.h"
#include "server/front/call/thread.h"
#include "server/session/limits.h"

namespace uplink::front {

void Call::Finish(const absl::Status& status) {
  UPLINK_CHECK(!over_, "a call ends once");
  over_ = true;
  finish_by_ = thread_.clock.Steady() + session::kFinishWait;
  response_.Finish(status);
  owner_.Touch(*this);
}

void Call::Fail(const absl::Status& status) {
  if (over_ || cancelled_ || closed_) return;
  thread_.book.TellFailure(status, owner_.origin(), thread_.clock.Steady());
  if (handler_ != nullptr) handler_->OnBroken(status.code());
  // What the handler still wanted to say is lost with it.
  response_.DropMessage();
  Finish(status);
}

void Call::Cancel() {
  cancelled_ = true;
  owner_.Touch(*this);
}

void Call::OnReset(std::uint32_t code) { reset_code_ = CodeOfReset(code); }

void Call::OnClosed() {
  closed_ = true;
  owner_.Touch(*this);
}

void Call::Break() {
  if (handler_ != nullptr) handler_->OnBroken(reset_code_);
  handler_.reset();
  finish_by_.reset();
  DropReceived();
  NoteUnfinished(0);
}

void Call::DrainAt(SteadyTime at, SteadyTime end) {
  drain_at_ = at;
  drain_end_ = end;
  SetTimer();
}

void Call::OnTimer() {
  timer_.reset();
  const SteadyTime now = thread_.clock.Steady();
  if (finish_by_ && now >= *finish_by_ && !closed_) {
    finish_by_.reset();
    thread_.relay.probe.finish_timeouts_total.Add();
    return Cancel();
  }
  if (head_ != nullptr && now >= *give_up_at_) return Cancel();
  if (serving()) {
    if (give_up_at_ && now >= *give_up_at_) {
      give_up_at_.reset();
      Fail(absl::DeadlineExceededError("the time that grpc-timeout gave is over"));
    } else if (drain_at_ && now >= *drain_at_) {
      drain_at_.reset();
      handler_->OnDrain(
          std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(drain_end_ - now)));
    } else if (handler_due_ && now >= *handler_due_) {
      handler_->OnTimer();
    }
  }
  owner_.Touch(*this);
}

void Call::SetTimer() {
  std::optional<SteadyTime> deadline = cancelled_ ? std::nullopt : finish_by_;
  const auto consider = [&deadline](const std::optional<SteadyTime>& at) {
    if (at && (!deadline || *at < *deadline)) deadline = at;
  };
  if (serving()) {
    handler_due_ = handler_->deadline();
    consider(handler_due_);
    consider(drain_at_);
  }
  if (serving() || head_ != nullptr) consider(give_up_at_);
  if (deadline) thread_.call_timers.Want(id_, timer_, *deadline, thread_.clock.Steady());
}

}  // namespace uplink::front
