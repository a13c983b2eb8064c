#include "server/front/call/relay_handler.h"

#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "server/front/call/outbound.h"
#include "server/front/call/thread.h"

namespace uplink::front {
namespace {

/// The frame as it goes out.
std::string WithPrefix(const v1::RelayResponse& frame) {
  const std::size_t bytes = frame.ByteSizeLong();
  std::string message(kPrefixBytes + bytes, '\0');
  transport::PutPrefix(bytes, message.data());
  const bool done = frame.SerializeToArray(message.data() + kPrefixBytes, static_cast<int>(bytes));
  UPLINK_CHECK(done, "a frame of ours does not serialize");
  return message;
}

}  // namespace

absl::StatusOr<std::unique_ptr<transport::CallHandler>> RelayHandler::Serve(Call& call) {
  Thread& thread = call.thread();
  transport::Entrant entrant = transport::EntrantOf(call.peer());
  if (absl::Status in = thread.gate.Enter(entrant); !in.ok()) {
    thread.book.TellRefusal(in, call.owner().origin(), thread.clock.Steady());
    return in;
  }
  std::unique_ptr<RelayHandler> handler(new RelayHandler(call, std::move(entrant)));
  handler->session_.emplace(thread.sessions, call.peer(), call.self(), *handler, *handler);
  thread.debug.StreamOpened(call.stream(), call.owner().origin());
  return handler;
}

RelayHandler::~RelayHandler() {
  session_.reset();
  Thread& thread = call_.thread();
  if (welcome_) thread.book.known().Leave(call_.owner().origin().source, thread.clock.Steady());
  thread.gate.Leave(entrant_);
}

void RelayHandler::OnBroken(std::optional<absl::StatusCode> code) {
  if (session_->done()) return;
  call_.thread().debug.StreamBroken(call_.stream(), call_.owner().origin(), session_->ruri());
  session_->OnBroken(code);
}

void RelayHandler::OnWritten() {
  if (!std::exchange(welcome_, true)) {
    call_.thread().book.known().Enter(call_.owner().origin().source);
  }
  session_->OnWritten();
}

void RelayHandler::Write(const v1::RelayResponse& frame) { call_.Write(WithPrefix(frame)); }

void RelayHandler::WriteEncoded(std::span<const session::EncodedFrame> frames) {
  call_.Write(std::vector<SharedMessage>(frames.begin(), frames.end()));
}

void RelayHandler::Finish(const absl::Status& status) {
  Thread& thread = call_.thread();
  Origin origin = call_.owner().origin();
  if (!origin.gateway.empty()) origin.robot = session_->ruri();
  if (session_->unconfirmed()) {
    thread.book.Tell("rejects_unconfirmed", "rejects_unconfirmed", std::string(status.message()),
                     origin, thread.clock.Steady());
  } else {
    thread.book.TellRefusal(status, origin, thread.clock.Steady());
  }
  thread.debug.StreamEnded(call_.stream(), origin, session_->ruri(), status);
  call_.Finish(status);
}

}  // namespace uplink::front
