#include "server/front/call/call.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"
#include "server/front/call/grpc_status.h"
#include "server/front/call/thread.h"
#include "server/front/http2/limits.h"
#include "server/session/limits.h"

namespace uplink::front {

using transport::MethodKind;

Call::Call(Thread& thread, CallOwner& owner, Http2& http2, std::int32_t stream)
    : thread_(thread),
      owner_(owner),
      http2_(http2),
      stream_(stream),
      id_(thread.next_call++),
      head_(std::make_unique<RequestHead>()),
      inbound_(thread.unfinished, self()),
      admittance_(thread, owner.origin()),
      response_(http2, stream) {
  thread_.calls.emplace(id_, this);
  // Headers that trickle in without end keep a place no longer than silence does.
  give_up_at_ = thread_.clock.Steady() + kFirstStreamWait;
}

Call::~Call() {
  thread_.calls.erase(id_);
  thread_.call_timers.Forget(id_, timer_);
}

loop::StreamRef Call::self() const { return {&thread_.inbox, id_}; }

void Call::OnHeadersEnd() {
  if (cancelled_) return;
  const std::unique_ptr<RequestHead> head = std::move(head_);
  give_up_at_.reset();
  const absl::Status may =
      transport::MayCall(owner_.tls_peer().identity, thread_.methods, head->path());
  if (!may.ok()) {
    TurnAway(may);
  } else if (const std::optional<int> http_status = head->NotGrpc()) {
    over_ = true;
    thread_.book.NoteRequest(fmt::format("HTTP {}: not a call of gRPC", *http_status),
                             owner_.origin(), thread_.clock.Steady());
    response_.FinishHttp(*http_status);
  } else {
    Serve(*head);
  }
  owner_.Touch(*this);
}

void Call::Serve(RequestHead& head) {
  if (absl::Status good = head.Judge(); !good.ok()) {
    if (head.foreign_encoding()) response_.NameEncodings();
    return Refuse(good);
  }
  if (std::optional<absl::Status> refusal = owner_.refusal()) return Finish(*refusal);
  const auto method = thread_.methods.find(head.path());
  if (method == thread_.methods.end()) {
    return Refuse(absl::UnimplementedError("no such method is served here"));
  }
  kind_ = method->second.kind;
  ended_ = &method->second.ended;
  const absl::Status in = admittance_.Enter(owner_.tls_peer().identity, method->second.admission);
  if (!in.ok()) return Finish(in);
  if (head.timeout()) {
    give_up_at_ = thread_.clock.Steady() + std::min<milliseconds>(*head.timeout(), kFarAway);
    at_deadline_ = method->second.at_deadline;
  }
  if (method->second.open) authorization_ = head.TakeAuthorization();
  auto handler = method->second.serve(*this);
  authorization_.clear();
  if (!handler.ok()) return Finish(handler.status());
  handler_ = *std::move(handler);
  handler_->Start();
}

void Call::TurnAway(const absl::Status& status) {
  unwelcome_ = true;
  thread_.relay.probe.refused_identity_total.Add();
  FinishRefused(status);
}

void Call::Refuse(const absl::Status& status) {
  thread_.book.NoteRequest(std::string(status.message()), owner_.origin(), thread_.clock.Steady());
  Finish(status);
}

void Call::OnData(std::string_view bytes) {
  if (!serving()) return http2_.ConsumeStream(stream_, bytes.size());
  inbound_.reader().Add(bytes);
  Deliver();
  if (wants_message_ && serving() && inbound_.reader().waiting() > 0) handler_->OnMessageBytes();
  inbound_.reader().Keep();
  NoteUnfinished();
  owner_.Touch(*this);
}

void Call::RequestMessage() {
  UPLINK_CHECK(!wants_message_, "a message has been asked for");
  inbound_.reader().SetMax(handler_->message_bytes_max());
  wants_message_ = true;
  owner_.Touch(*this);
}

void Call::Deliver() {
  while (wants_message_ && serving()) {
    if (!DeliverOne()) break;
  }
  if (!serving()) OpenWindow(inbound_.Drop());
}

bool Call::DeliverOne() {
  using Kind = MessageReader::Next::Kind;
  const MessageReader::Next next = inbound_.reader().Peek();
  switch (next.kind) {
    case Kind::kNone:
      if (peer_ended_) EndOfMessages();
      return false;
    case Kind::kMessage:
      if (kind_ != MethodKind::kBidirectional && inbound_.reader().popped() > 0) {
        Fail(absl::InternalError("the method takes one message, and more came"));
        return false;
      }
      wants_message_ = false;
      handler_->OnMessage(next.message);
      OpenWindow(inbound_.Pop());
      return true;
    case Kind::kTooLarge:
      wants_message_ = false;
      handler_->OnTooLarge(next.bytes);
      return false;
    case Kind::kBadFlag:
      Fail(absl::InternalError(
          "a message is flagged as compressed, and the call names no encoding"));
      return false;
  }
  return false;
}

void Call::EndOfMessages() {
  if (inbound_.reader().waiting() > 0) {
    return Fail(absl::InternalError("the stream ended within a message"));
  }
  if (kind_ != MethodKind::kBidirectional && inbound_.reader().popped() == 0) {
    return Fail(absl::InternalError("the method takes one message, and none came"));
  }
  wants_message_ = false;
  handler_->OnHalfClose();
}

void Call::NoteUnfinished() {
  OpenWindow(inbound_.NoteUnfinished(serving() && wants_message_, owner_.tls_peer().key,
                                     thread_.clock.Steady()));
}

// --- The response ---

void Call::BeginWrite() {
  UPLINK_CHECK(!response_.writing() && serving(), "a write is under way, or the call ends");
  const bool first = !std::exchange(has_written_, true);
  UPLINK_CHECK(first || kind_ != MethodKind::kUnary, "a unary call has one answer");
}

Http2Stream::Body Call::OnBody(char* into, std::size_t size) {
  const bool was_writing = response_.writing();
  const Body body = response_.Take(into, size);
  if (was_writing && !response_.writing()) {
    written_ = true;
    if (serving() || kind_ == MethodKind::kUnary) admittance_.NoteAnswered();
    owner_.Touch(*this);
  }
  return body;
}

// --- What its connection asks ---

void Call::Settle() {
  if (closed_) return Break();
  if (cancelled_) {
    if (!std::exchange(reset_sent_, true)) {
      Break();
      http2_.Reset(stream_, NGHTTP2_CANCEL);
    }
    return;
  }
  if (std::exchange(written_, false) && serving()) handler_->OnWritten();
  Deliver();
  NoteUnfinished();
  SetTimer();
}

void Call::OnWake() {
  if (inbound_.MustEnd()) {
    thread_.relay.probe.unfinished_ends_total.Add();
    Fail(absl::ResourceExhaustedError(
             "the memory for unfinished frames is used up, and this one was the slowest"),
         transport::EndCause::kBound);
  }
  if (serving()) handler_->OnWake();
  owner_.Touch(*this);
}

// --- How it ends: by its handler, its peer, its connection, or when its time is over ---

void Call::Finish(const absl::Status& status) {
  UPLINK_CHECK(!over_, "a call ends once");
  over_ = true;
  finish_by_ = thread_.clock.Steady() + session::kFinishWait;
  response_.Finish(status);
  NoteEnd(status.code());
  owner_.Touch(*this);
}

void Call::FinishRefused(const absl::Status& status) {
  thread_.book.TellRefusal(status, owner_.origin(), thread_.clock.Steady());
  Finish(status);
}

void Call::Fail(const absl::Status& status, transport::EndCause cause) {
  if (over_ || cancelled_ || closed_) return;
  thread_.book.TellFailure(status, owner_.origin(), thread_.clock.Steady());
  if (handler_ != nullptr) handler_->OnBroken(transport::EndingWith(cause, status));
  // What the handler still wanted to send is lost with it.
  response_.DropMessage();
  Finish(status);
}

void Call::Break() {
  if (handler_ != nullptr) {
    handler_->OnBroken({.cause = CauseOfBreak(), .code = reset_code_});
  }
  NoteEnd(std::nullopt);
  handler_.reset();
  admittance_.Leave();
  finish_by_.reset();
  OpenWindow(inbound_.Drop());
  inbound_.End();
}

transport::EndCause Call::CauseOfBreak() const {
  using transport::EndCause;
  if (reset_code_) return EndCause::kReset;
  // A stream that ends on a connection that goes on was reset by nghttp2, for a fault of the peer.
  return owner_.connection().noted().value_or(closed_ ? EndCause::kBrokeRules : EndCause::kCut);
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
      Fail(at_deadline_);
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
