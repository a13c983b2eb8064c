#include "server/front/call/grpc_connection.h"

#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nghttp2/nghttp2.h>

namespace uplink::front {

using transport::EndCause;
using transport::TurnedAway;

namespace {

/// What ends the calls of a connection that is turned away after its handshake.
EndCause EndCauseOf(TurnedAway cause) {
  switch (cause) {
    case TurnedAway::kNotRead:
      return EndCause::kNotRead;
    case TurnedAway::kSilent:
      return EndCause::kUnanswered;
    case TurnedAway::kFull:
    case TurnedAway::kCrowded:
    case TurnedAway::kGaveWay:
    case TurnedAway::kKey:
    case TurnedAway::kNoStream:
      return EndCause::kBound;
    case TurnedAway::kHandshakeTimeout:
    case TurnedAway::kNoTls:
    case TurnedAway::kNothingShared:
    case TurnedAway::kNoCertificate:
    case TurnedAway::kUntrusted:
    case TurnedAway::kHandshakeError:
    case TurnedAway::kProtocol:
    case TurnedAway::kPings:
    case TurnedAway::kPongs:
    case TurnedAway::kResets:
    case TurnedAway::kSettings:
    case TurnedAway::kEmptyData:
    case TurnedAway::kPriorities:
    case TurnedAway::kWindowUpdates:
    case TurnedAway::kUnknownFrames:
    case TurnedAway::kHeaders:
    case TurnedAway::kContinuations:
    case TurnedAway::kKeyUpdates:
    case TurnedAway::kProxyHeader:
    case TurnedAway::kCertificate:
      return EndCause::kBrokeRules;
  }
  return EndCause::kBrokeRules;
}

}  // namespace

GrpcConnection::GrpcConnection(Thread& thread, GrpcConnectionOwner& owner, Setup setup)
    : thread_(thread),
      owner_(owner),
      peer_(std::move(setup.peer)),
      origin_(setup.origin),
      connection_(origin_.text, peer_.certificate),
      http2_(thread.http2_rules, thread.http2_memory, *this, setup.streams_max),
      frames_(setup.streams_max, setup.calls_per_second) {}

bool GrpcConnection::Receive(std::string_view plain) {
  if (http2_.Receive(plain)) return true;
  TurnAway(TurnedAway::kProtocol, "");
  return false;
}

void GrpcConnection::EndFlood() {
  http2_.End(NGHTTP2_ENHANCE_YOUR_CALM, kFloodedText);
  TurnAway(TurnedAway::kProtocol, "");
}

void GrpcConnection::TurnAway(TurnedAway cause, std::string_view text) {
  if (std::exchange(turned_away_, true)) return;
  connection_.NoteEnd(EndCauseOf(cause));
  thread_.book.Note(cause, origin_, thread_.clock.Steady());
  // After a failed Receive the session has already sent why it ends.
  if (cause != TurnedAway::kProtocol) http2_.End(NGHTTP2_ENHANCE_YOUR_CALM, text);
}

void GrpcConnection::Ban(const absl::Status& why, EndCause cause) {
  connection_.NoteEnd(cause);
  ban_ = why;
  ending_ = true;
  calls_.Fail(why, cause);
}

void GrpcConnection::SettleCalls() {
  const bool had_calls = calls_.size() > 0;
  calls_.Settle([this](const Call& call) {
    served_ = served_ || call.has_handler();
    answered_ = answered_ || call.answered();
    if (call.finished() && call.unwelcome()) ending_ = true;
  });
  if (had_calls && calls_.size() == 0) owner_.OnCalls(0);
}

bool GrpcConnection::EndIfLast() {
  if (!ending_ || calls_.size() > 0 || std::exchange(last_streams_told_, true)) return false;
  End();
  return true;
}

void GrpcConnection::Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end,
                           EndCause cause) {
  connection_.NoteDrain(cause);
  if (!std::exchange(ending_, true)) http2_.NoticeEnd();
  calls_.Drain(spread, first, end);
}

void GrpcConnection::End() { http2_.End(NGHTTP2_NO_ERROR, ""); }

std::optional<absl::Status> GrpcConnection::refusal() const {
  if (ban_) return ban_;
  if (thread_.gate.closed()) {
    thread_.relay.probe.refused_draining_total.Add();
    return absl::UnavailableError("the server drains");
  }
  if (!ending_) return std::nullopt;
  return absl::UnavailableError("the connection ends; a new one is served");
}

Http2Stream* GrpcConnection::OnStream(std::int32_t id) {
  Call& call = calls_.Open(std::make_unique<Call>(thread_, *this, http2_, id));
  calls_.Touch(call);
  if (calls_.size() == 1) owner_.OnCalls(1);
  return &call;
}

void GrpcConnection::OnFrame(FrameKind kind) {
  const SteadyTime now = thread_.clock.Steady();
  if (frames_.TakeForSent(kind, now)) return;
  if (!frames_.Take(kind, now)) return TurnAway(LimitOf(kind).cause, LimitOf(kind).label);
  if (kind == FrameKind::kPing && pings_.OnPing(now) == PingStrikes::Verdict::kTooMany) {
    // gRPC's clients know these words, and ping less from then on.
    TurnAway(TurnedAway::kPings, "too_many_pings");
  }
}

void GrpcConnection::OnSent() {
  frames_.NoteSent(thread_.clock.Steady());
  pings_.OnSent();
}

void GrpcConnection::OnStreamFault(std::string_view code) {
  if (turned_away_) return;
  thread_.book.NoteRequest(fmt::format("it breaks a rule of HTTP/2: {}", code), origin_,
                           thread_.clock.Steady());
  OnFrame(FrameKind::kReset);
}

}  // namespace uplink::front
