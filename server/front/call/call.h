#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/check.h"
#include "server/front/call/admittance.h"
#include "server/front/call/caller_proof.h"
#include "server/front/call/grpc_status.h"
#include "server/front/call/inbound.h"
#include "server/front/call/request_head.h"
#include "server/front/call/response.h"
#include "server/front/door/origin.h"
#include "server/front/http2/http2.h"
#include "server/front/tls/tls_peer.h"
#include "server/transport/call_handler.h"
#include "server/transport/methods.h"
#include "server/transport/timers.h"

namespace uplink::front {

class Call;
struct Thread;

/// Owns and settles a connection's calls.
class CallOwner {
 public:
  virtual ~CallOwner() = default;
  /// Notes that the call needs Call::Settle, which must wait until nghttp2 has returned.
  virtual void Touch(Call& call) = 0;
  /// Settles touched calls, and may destroy them.
  virtual void Settle() = 0;
  [[nodiscard]] virtual const TlsPeer& tls_peer() const = 0;
  [[nodiscard]] virtual const Origin& origin() const = 0;
  [[nodiscard]] virtual transport::PeerConnection& connection() = 0;
  /// Asks the peer for an answer; then Call::OnPeerAnswered of all its calls follows.
  virtual void AskPeer() = 0;
  /// ServedCall::NoteCaller.
  virtual void NoteCaller(std::string_view name) = 0;
  /// Why no new call is served here, counted if it is a drain; empty while calls are served.
  [[nodiscard]] virtual std::optional<absl::Status> refusal() const = 0;
};

/// One gRPC call on an HTTP/2 stream: headers, messages out of DATA, the response, trailers. Its
/// handler knows what the messages mean.
///
/// Life:   made when the stream opens; `finished()` once the stream is gone; destroyed by its
///         connection then.
/// Thread: confined to its connection's.
class Call final : public Http2Stream, public transport::ServedCall {
 public:
  Call(Thread& thread, CallOwner& owner, Http2& http2, std::int32_t stream);
  ~Call() override;
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  // transport::ServedCall
  void RequestMessage() override;
  void Write(std::string message_with_prefix) override {
    BeginWrite();
    response_.Write(std::move(message_with_prefix));
    owner_.Touch(*this);
  }
  void Write(std::vector<SharedMessage> messages) override {
    BeginWrite();
    response_.Write(std::move(messages));
    owner_.Touch(*this);
  }
  void Finish(const absl::Status& status) override;
  void FinishRefused(const absl::Status& status) override;
  void Cancel() override {
    cancelled_ = true;
    owner_.Touch(*this);
  }
  void AskPeer() override {
    asks_peer_ = true;
    owner_.AskPeer();
  }
  void NoteCaller(std::string_view name) override { owner_.NoteCaller(name); }
  [[nodiscard]] const identity::PeerIdentity& peer() const override {
    const auto& identity = owner_.tls_peer().identity;
    UPLINK_CHECK(identity.ok(), "a call is served for who may call it");
    return *identity;
  }
  [[nodiscard]] transport::CallerProof proof() const override {
    return ProofOf(owner_.tls_peer(), owner_.origin(), authorization_);
  }
  [[nodiscard]] transport::PeerConnection* connection() override { return &owner_.connection(); }
  [[nodiscard]] std::optional<SteadyTime> give_up_at() const override { return give_up_at_; }
  [[nodiscard]] loop::StreamRef self() const override;

  // --- For the relay's handler ---

  [[nodiscard]] Thread& thread() { return thread_; }
  [[nodiscard]] CallOwner& owner() const { return owner_; }

  // --- For its connection ---

  /// Does what was deferred while nghttp2 ran.
  void Settle();
  void OnWake();
  void OnTimer();
  void OnPeerAnswered() {
    if (std::exchange(asks_peer_, false) && serving()) handler_->OnPeerAnswered();
  }
  /// Calls the handler's OnDrain at `at`, with the time that is then left until `end`.
  void DrainAt(SteadyTime at, SteadyTime end);
  /// The connection is gone.
  void Break();
  /// Ends the call with a status of ours, regardless of its handler.
  void Fail(const absl::Status& status, transport::EndCause cause);
  /// The same for a peer that breaks a rule of gRPC.
  void Fail(const absl::Status& status) { Fail(status, transport::EndCause::kBrokeRules); }
  [[nodiscard]] bool finished() const { return closed_; }
  /// Its end was decided, and sent.
  [[nodiscard]] bool answered() const { return over_; }
  [[nodiscard]] bool has_handler() const { return handler_ != nullptr; }
  /// Its peer may not make this call, and was told why.
  [[nodiscard]] bool unwelcome() const { return unwelcome_; }
  [[nodiscard]] std::int32_t stream() const { return stream_; }
  /// It is in its owner's list of touched calls.
  bool touched = false;

  // Http2Stream
  bool OnHeader(std::string_view name, std::string_view value) override {
    return head_ != nullptr && head_->Add(name, value);
  }
  void OnHeadersEnd() override;
  void OnData(std::string_view bytes) override;
  void OnEnd() override {
    peer_ended_ = true;
    Deliver();
    owner_.Touch(*this);
  }
  void OnReset(std::uint32_t code) override { reset_code_ = CodeOfReset(code); }
  void OnClosed() override {
    closed_ = true;
    owner_.Touch(*this);
  }
  Body OnBody(char* into, std::size_t size) override;
  void OnBodyEnd() override { response_.SendTrailers(); }

 private:
  void Serve(RequestHead& head);
  /// Ends a call that its peer may not make.
  void TurnAway(const absl::Status& status);
  /// Ends a call to a method that we do not serve.
  void Refuse(const absl::Status& status);
  /// Gives the handler messages while it waits for one and some are there.
  void Deliver();
  bool DeliverOne();
  void EndOfMessages();
  void OpenWindow(Inbound::WindowBytes bytes) {
    if (bytes > 0) http2_.ConsumeStream(stream_, bytes);
  }
  /// Notes the memory of the message that the handler waits for.
  void NoteUnfinished();
  void SetTimer();
  /// A write may begin.
  void BeginWrite();
  /// Tells the method of its end, once.
  void NoteEnd(std::optional<absl::StatusCode> code) {
    if (const auto* told = std::exchange(ended_, nullptr); told != nullptr && *told) (*told)(code);
  }
  /// Why the peer gets nothing more.
  [[nodiscard]] transport::EndCause CauseOfBreak() const;
  [[nodiscard]] bool serving() const { return handler_ != nullptr && !over_ && !cancelled_; }

  Thread& thread_;
  CallOwner& owner_;
  Http2& http2_;
  const std::int32_t stream_;
  const std::uint64_t id_;

  /// Until the request's headers are whole.
  std::unique_ptr<RequestHead> head_;
  /// While an open method's handler is made.
  std::string authorization_;
  Inbound inbound_;
  bool wants_message_ = false;
  bool has_written_ = false;
  bool asks_peer_ = false;
  bool peer_ended_ = false;
  transport::MethodKind kind_ = transport::MethodKind::kBidirectional;
  /// The method's, until it was told.
  const std::function<void(std::optional<absl::StatusCode>)>* ended_ = nullptr;
  Admittance admittance_;

  Response response_;
  /// The peer took what the handler wrote, and the handler was not told yet.
  bool written_ = false;
  /// Its end is decided.
  bool over_ = false;
  std::optional<SteadyTime> finish_by_;
  /// The deadline by grpc-timeout; before the headers are complete, the deadline for them.
  std::optional<SteadyTime> give_up_at_;
  /// The status at that deadline.
  absl::Status at_deadline_;
  std::optional<SteadyTime> drain_at_;
  SteadyTime drain_end_;
  /// What the handler's deadline() last returned. Once it has passed, the handler may return
  /// nothing.
  std::optional<SteadyTime> handler_due_;
  transport::Timers::Slot timer_;
  bool unwelcome_ = false;
  /// The status that the peer's reset means.
  std::optional<absl::StatusCode> reset_code_;
  bool cancelled_ = false;
  bool reset_sent_ = false;
  bool closed_ = false;

  /// Last, so that it is destroyed before what it writes to.
  std::unique_ptr<transport::CallHandler> handler_;
};

}  // namespace uplink::front
