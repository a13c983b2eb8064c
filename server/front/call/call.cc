#include "server/front/call/call.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nghttp2/nghttp2.h>

#include "schema/base/check.h"
#include "server/front/call/thread.h"
#include "server/front/http2/limits.h"

namespace uplink::front {
Call::Call(Thread& thread, CallOwner& owner, Http2& http2, std::int32_t stream)
    : thread_(thread),
      owner_(owner),
      http2_(http2),
      stream_(stream),
      id_(thread.next_call++),
      head_(std::make_unique<RequestHead>()),
      response_(http2, stream) {
  thread_.calls.emplace(id_, this);
  // Headers that trickle in, and never end, keep a place no longer than silence does.
  give_up_at_ = thread_.clock.Steady() + kFirstStreamWait;
}

Call::~Call() {
  thread_.calls.erase(id_);
  thread_.call_timers.Forget(id_, timer_);
  NoteUnfinished(0);
}

// --- The request ---

bool Call::OnHeader(std::string_view name, std::string_view value) {
  return head_ != nullptr && head_->Add(name, value);
}

void Call::OnHeadersEnd() {
  if (cancelled_) return;
  const std::unique_ptr<RequestHead> head = std::move(head_);
  give_up_at_.reset();
  const absl::Status may = MayCall(owner_.tls_peer().identity, thread_.methods, head->path());
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

void Call::Serve(const RequestHead& head) {
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
  auto handler = method->second.serve(*this);
  if (!handler.ok()) return Finish(handler.status());
  handler_ = *std::move(handler);
  if (head.timeout()) {
    give_up_at_ = thread_.clock.Steady() + std::min<milliseconds>(*head.timeout(), kFarAway);
  }
  handler_->Start();
}

void Call::TurnAway(const absl::Status& status) {
  unwelcome_ = true;
  thread_.relay.probe.refused_identity_total.Add();
  thread_.book.TellRefusal(status, owner_.origin(), thread_.clock.Steady());
  Finish(status);
}

void Call::Refuse(const absl::Status& status) {
  thread_.book.NoteRequest(std::string(status.message()), owner_.origin(), thread_.clock.Steady());
  Finish(status);
}

void Call::OnData(std::string_view bytes) {
  if (!serving()) return http2_.ConsumeStream(stream_, bytes.size());
  reader_.Add(bytes);
  Deliver();
  if (wants_message_ && serving() && reader_.waiting() > 0) handler_->OnMessageBytes();
  reader_.Keep();
  ConsumeUnfinished();
  owner_.Touch(*this);
}

void Call::OnEnd() {
  peer_ended_ = true;
  Deliver();
  owner_.Touch(*this);
}

void Call::RequestMessage() {
  UPLINK_CHECK(!wants_message_, "a message has been asked for");
  reader_.SetMax(handler_->message_bytes_max());
  wants_message_ = true;
  owner_.Touch(*this);
}

void Call::Deliver() {
  while (wants_message_ && serving()) {
    if (!DeliverOne()) break;
  }
  if (!serving()) DropReceived();
}

bool Call::DeliverOne() {
  using Kind = MessageReader::Next::Kind;
  const MessageReader::Next next = reader_.Peek();
  switch (next.kind) {
    case Kind::kNone:
      if (peer_ended_) EndOfMessages();
      return false;
    case Kind::kMessage:
      if (kind_ != MethodKind::kBidirectional && reader_.popped() > 0) {
        Fail(absl::InternalError("the method takes one message, and more came"));
        return false;
      }
      wants_message_ = false;
      handler_->OnMessage(next.message);
      Consume(reader_.Pop());
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
  if (reader_.waiting() > 0) return Fail(absl::InternalError("the stream ended within a message"));
  if (kind_ != MethodKind::kBidirectional && reader_.popped() == 0) {
    return Fail(absl::InternalError("the method takes one message, and none came"));
  }
  wants_message_ = false;
  handler_->OnHalfClose();
}

void Call::Consume(std::size_t taken) {
  const std::size_t early = std::exchange(consumed_early_, 0);
  if (taken > early) http2_.ConsumeStream(stream_, taken - early);
}

void Call::ConsumeUnfinished() {
  const std::optional<std::size_t> whole =
      serving() && wants_message_ ? reader_.unfinished() : std::nullopt;
  // nghttp2 tells the peer of a window once half of it was given back: as much as that half may be
  // missing from what a message can count on.
  if (whole && *whole > static_cast<std::size_t>(kStreamWindowBytes) / 2) {
    // All that waits belongs to it.
    const std::size_t waiting = reader_.waiting();
    http2_.ConsumeStream(stream_, waiting - consumed_early_);
    consumed_early_ = waiting;
  }
  NoteUnfinished(whole ? reader_.held() : 0);
}

void Call::NoteUnfinished(std::size_t bytes) {
  const std::uint64_t message = bytes > 0 ? reader_.popped() : 0;
  if (bytes == unfinished_bytes_ && message == unfinished_message_) return;
  unfinished_bytes_ = bytes;
  unfinished_message_ = message;
  thread_.unfinished.Set({&thread_.inbox, id_}, owner_.tls_peer().key, message, bytes,
                         thread_.clock.Steady());
}

void Call::DropReceived() {
  Consume(reader_.waiting());
  reader_.Clear();
}

// --- The response ---

void Call::Write(std::string message_with_prefix) {
  BeginWrite();
  response_.Write(std::move(message_with_prefix));
  owner_.Touch(*this);
}

void Call::Write(std::vector<SharedMessage> messages) {
  BeginWrite();
  response_.Write(std::move(messages));
  owner_.Touch(*this);
}

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
  ConsumeUnfinished();
  SetTimer();
}

void Call::OnWake() {
  if (unfinished_bytes_ > 0 && thread_.unfinished.ToEnd({&thread_.inbox, id_})) {
    thread_.relay.probe.unfinished_ends_total.Add();
    Fail(absl::ResourceExhaustedError(
        "the memory for unfinished frames is used up, and this one was the slowest"));
  }
  if (serving()) handler_->OnWake();
  owner_.Touch(*this);
}

}  // namespace uplink::front
