#include "server/front/connection.h"

#include <utility>

#include <fmt/format.h>
#include <nghttp2/nghttp2.h>

#include "server/front/call/thread.h"
#include "server/front/http2/limits.h"

namespace uplink::front {
using transport::TurnedAway;

Connection::Connection(Thread& thread, EventLoop& loop, ConnectionOwner& owner, Setup setup)
    : thread_(thread),
      owner_(owner),
      id_(setup.id),
      origin_(std::move(setup.origin)),
      age_max_(setup.age_max),
      gateway_streams_max_(setup.gateway_streams_max),
      socket_(loop, setup.descriptor, *this, thread.received),
      tls_(std::make_unique<TlsEngine>(std::move(setup.tls), thread.buffer_method, thread.tls)),
      place_(thread.book, setup.id) {}

Connection::~Connection() { thread_.connection_timers.Forget(id_, timer_); }

void Connection::Start() {
  phase_by_ = thread_.clock.Steady() + kHandshakeWaitPressed;
  handshake_by_ = thread_.clock.Steady() + kHandshakeWait;
  if (!socket_.Start()) return Close();
  Settle();
}

void Connection::OnReceived(std::string_view bytes) {
  thread_.clock.Advance();
  const SteadyTime now = thread_.clock.Steady();
  lifetime_.Heard(now);
  place_.NoteHeard(now);
  if (phase_ == Phase::kLinger && ++linger_reads_ > kLingerReadsMax) return Close();
  if (phase_ == Phase::kLinger || phase_ == Phase::kClosed) return;
  thread_.tls.in = bytes;
  if (phase_ == Phase::kHandshake) Handshake();
  if (phase_ == Phase::kOpen) ReadPlain();
  thread_.tls.in = {};
}

void Connection::Handshake() {
  switch (tls_->Handshake()) {
    case TlsEngine::Step::kMore:
      return;
    case TlsEngine::Step::kFailed:
      FailHandshake(CauseOf(tls_->failure()));
      return Linger();
    case TlsEngine::Step::kDone:
      return BeginHttp2();
  }
}

void Connection::BeginHttp2() {
  const SteadyTime now = thread_.clock.Steady();
  peer_ = tls_->Peer();
  origin_.NotePeer(peer_->ruri, peer_->gateway, peer_->subject);
  phase_ = Phase::kOpen;
  phase_by_.reset();
  const std::uint32_t streams_max = peer_->IsGateway() ? gateway_streams_max_ : kRobotStreamsMax;
  frames_ = FrameRates(streams_max);
  http2_ = std::make_unique<Http2>(thread_.http2_rules, thread_.http2_memory, *this, streams_max);
  lifetime_.Open(now, age_max_, UntilExpiry(), peer_->jitter());
  owner_.OnHandshakeEnded(*this);
  thread_.debug.ConnectionOpened(id_, origin_);
  if (!place_.Take()) {
    return TurnAway(TurnedAway::kFull, "the server has no place for more connections");
  }
  if (const auto evicted = place_.Count(*peer_, origin_, now)) owner_.OnEvicted(*evicted);
}

void Connection::ReadPlain() {
  while (phase_ == Phase::kOpen) {
    const std::optional<std::string_view> plain = tls_->Read();
    if (!plain) break;
    if (plain->empty()) {
      // One of them costs some 10 us, and 27 bytes: each is counted before the next is read.
      OnFrame(FrameKind::kKeyUpdate);
      if (turned_away_) break;
      continue;
    }
    if (http2_->Receive(*plain) && AnswersGoOut()) continue;
    TurnAway(TurnedAway::kProtocol, "");
    break;
  }
  if (tls_->over()) OnReceiveEnd();
}

bool Connection::AnswersGoOut() {
  if (turned_away_ || !http2_->flooded()) return true;
  // They go out ahead of all else: those that still wait are what the peer does not read.
  static_cast<void>(Flush());
  if (phase_ != Phase::kOpen || !http2_->flooded()) return true;
  http2_->End(NGHTTP2_ENHANCE_YOUR_CALM, kFloodedText);
  return false;
}

void Connection::OnReceiveEnd() {
  thread_.clock.Advance();
  // A handshake for nothing, unless we sent it away.
  if (phase_ == Phase::kHandshake && tls_->begun()) FailHandshake(TurnedAway::kHandshakeError);
  if (phase_ == Phase::kOpen && !turned_away_ && !ending_ && !lifetime_.served() && !answered_) {
    thread_.book.Note(TurnedAway::kNoStream, origin_, thread_.clock.Steady());
  }
  Close();
}

void Connection::OnUnblocked() {
  thread_.clock.Advance();
  lifetime_.SetBlocked(false, {}, thread_.clock.Steady());
  if (phase_ == Phase::kLinger) socket_.EndOutput();
}

Turn Connection::turn() const {
  if (phase_ != Phase::kHandshake) return Turn::kNow;
  if (origin_.own) return Turn::kOwnHandshake;
  return origin_.known ? Turn::kKnownHandshake : Turn::kHandshake;
}

// --- Streams ---

Http2Stream* Connection::OnStream(std::int32_t id) {
  Call& call = calls_.Open(std::make_unique<Call>(thread_, *this, *http2_, id));
  calls_.Touch(call);
  if (calls_.size() == 1) NoteCalls();
  return &call;
}

void Connection::OnFrame(FrameKind kind) {
  const SteadyTime now = thread_.clock.Steady();
  if (frames_.TakeForSent(kind, now)) return;
  if (!frames_.Take(kind, now)) return TurnAway(LimitOf(kind).cause, LimitOf(kind).label);
  if (kind == FrameKind::kPing && pings_.OnPing(now) == PingStrikes::Verdict::kTooMany) {
    // The words that gRPC's clients know: they ping less from then on.
    TurnAway(TurnedAway::kPings, "too_many_pings");
  }
}

void Connection::OnSent() {
  frames_.NoteSent(thread_.clock.Steady());
  pings_.OnSent();
}

void Connection::OnStreamFault(std::string_view code) {
  if (turned_away_) return;
  thread_.book.NoteRequest(fmt::format("it breaks a rule of HTTP/2: {}", code), origin_,
                           thread_.clock.Steady());
  OnFrame(FrameKind::kReset);
}

void Connection::TurnAway(TurnedAway cause, std::string_view text) {
  if (std::exchange(turned_away_, true)) return;
  thread_.book.Note(cause, origin_, thread_.clock.Steady());
  // After Receive has failed the session has said itself why it ends.
  if (cause != TurnedAway::kProtocol) http2_->End(NGHTTP2_ENHANCE_YOUR_CALM, text);
}

void Connection::FailHandshake(TurnedAway cause) {
  thread_.debug.HandshakeFailed(id_, origin_,
                                transport::kTurnedAwayTexts[static_cast<std::size_t>(cause)]);
  thread_.book.NoteFailedHandshake(cause, tls_->detail(), origin_, thread_.clock.Steady());
}

std::optional<absl::Status> Connection::refusal() const {
  if (thread_.gate.closed()) {
    thread_.relay.probe.refused_draining_total.Add();
    return absl::UnavailableError("the server drains");
  }
  if (!ending_) return std::nullopt;
  return absl::UnavailableError("the connection ends; a new one is served");
}

void Connection::NoteCalls() {
  lifetime_.SetCalls(calls_.size(), thread_.clock.Steady());
  place_.SetStreams(calls_.size());
}

void Connection::SettleCalls() {
  const bool had_calls = calls_.size() > 0;
  calls_.Settle([this](const Call& call) {
    if (call.has_handler()) lifetime_.NoteServed();
    answered_ = answered_ || call.answered();
    if (call.finished() && call.unwelcome()) ending_ = true;
  });
  if (had_calls && calls_.size() == 0) NoteCalls();
}

// --- What is said ---

void Connection::Settle() {
  if (phase_ == Phase::kClosed) return;
  do {
    SettleCalls();
  } while (Flush() || !calls_.settled());
  EndIfDone();
  if (phase_ == Phase::kClosed) return;
  const bool goes = turned_away_ || ending_;
  lifetime_.SetBlocked(socket_.blocked(), goes ? kAgeGrace : kBlockedWait, thread_.clock.Steady());
  SetTimer();
}

bool Connection::Flush() {
  std::string& out = thread_.tls.out;
  bool good = true;
  while (good && phase_ == Phase::kOpen && !socket_.blocked() && out.size() < kSendBytesMax) {
    http2_->Gather(thread_.gathered, kRecordBytes);
    if (thread_.gathered.empty()) break;
    good = tls_->Write(thread_.gathered);
  }
  const bool something = !out.empty();
  if (something && phase_ != Phase::kClosed) good = socket_.Send(out) && good;
  out.clear();
  if (socket_.kept_bytes() > kKeptBytesMax) {
    thread_.book.Note(TurnedAway::kNotRead, origin_, thread_.clock.Steady());
    good = false;
  }
  if (!good) Close();
  return something && phase_ == Phase::kOpen && !socket_.blocked();
}

void Connection::EndIfDone() {
  if (phase_ != Phase::kOpen) return;
  if (ending_ && calls_.size() == 0 && !std::exchange(last_streams_told_, true)) {
    http2_->End(NGHTTP2_NO_ERROR, "");
    static_cast<void>(Flush());
  }
  if (phase_ == Phase::kOpen && http2_->over()) Linger();
}

void Connection::Linger() {
  if (phase_ == Phase::kOpen) tls_->WriteEnd();
  static_cast<void>(Flush());
  if (phase_ == Phase::kClosed) return;
  const bool was_handshake = phase_ == Phase::kHandshake;
  // An alert means nothing to who speaks no TLS; and only so many descriptors may wait.
  if (tls_->failure() == TlsEngine::Failure::kNoTls) return Close();
  if (!place_.Linger(peer_ ? std::optional(peer_->key) : std::nullopt)) return Close();
  phase_ = Phase::kLinger;
  if (was_handshake) owner_.OnHandshakeEnded(*this);
  calls_.Break();
  // A peer that has not read all yet gets the time to.
  const bool blocked = socket_.blocked();
  if (!blocked) socket_.EndOutput();
  phase_by_ = thread_.clock.Steady() + (blocked ? kAgeGrace : kLingerWait);
}

void Connection::Close() {
  if (phase_ == Phase::kClosed) return;
  const bool was_handshake = phase_ == Phase::kHandshake;
  phase_ = Phase::kClosed;
  // What TLS still wanted to say is this connection's, and the buffer the thread's.
  thread_.tls.out.clear();
  calls_.Break();
  socket_.Close();
  place_.Leave();
  thread_.connection_timers.Forget(id_, timer_);
  thread_.debug.ConnectionClosed(id_, origin_);
  if (was_handshake) owner_.OnHandshakeEnded(*this);
  owner_.OnClosed(*this);
}

}  // namespace uplink::front
