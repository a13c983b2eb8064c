#include "server/front/connection.h"

#include <algorithm>
#include <utility>

#include "server/front/call/thread.h"
#include "server/front/http2/limits.h"

namespace uplink::front {

using transport::EndCause;
using transport::TurnedAway;

Connection::Connection(Thread& thread, EventLoop& loop, ConnectionOwner& owner, Setup setup)
    : thread_(thread),
      owner_(owner),
      id_(setup.id),
      origin_(std::move(setup.origin)),
      age_max_(setup.age_max),
      gateway_streams_max_(setup.gateway_streams_max),
      served_(setup.served),
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
  lifetime_.NoteHeard(now);
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
      return BeginGrpc();
  }
}

void Connection::BeginGrpc() {
  const SteadyTime now = thread_.clock.Steady();
  TlsPeer peer = JudgedPeer();
  // Those without a certificate share the places of their source.
  if (peer.anonymous) peer.key = KeyOf(origin_.source);
  origin_.NotePeer(peer.ruri, peer.gateway, peer.subject);
  phase_ = Phase::kOpen;
  phase_by_.reset();
  GrpcConnection::Setup setup{.peer = std::move(peer), .origin = origin_};
  setup.streams_max = setup.peer.IsGateway() ? gateway_streams_max_ : kRobotStreamsMax;
  if (thread_.serves_calls) {
    setup.calls_per_second = setup.streams_max * kCallsPerStream;
    if (!setup.peer.IsGateway()) setup.streams_max += kRobotCallsMax;
  }
  grpc_ = std::make_unique<GrpcConnection>(thread_, *this, std::move(setup));
  lifetime_.Open(now, age_max_, UntilExpiry(), grpc_->tls_peer().jitter());
  owner_.OnHandshakeEnded(*this);
  thread_.debug.ConnectionOpened(id_, origin_);
  if (!place_.Take()) {
    return grpc_->TurnAway(TurnedAway::kFull, "the server has no place for more connections");
  }
  const auto evicted = place_.Count(grpc_->tls_peer(), origin_, now);
  if (evicted) owner_.EvictOther(*evicted);
}

void Connection::ReadPlain() {
  while (phase_ == Phase::kOpen) {
    const std::optional<std::string_view> plain = tls_->Read();
    if (!plain) break;
    if (plain->empty()) {
      // One of them costs some 10 us, and 27 bytes: each is counted before the next is read.
      grpc_->OnFrame(FrameKind::kKeyUpdate);
      if (grpc_->turned_away()) break;
      continue;
    }
    if (!grpc_->Receive(*plain)) break;
    if (grpc_->turned_away() || !grpc_->http2().flooded()) continue;
    // Answers go out first, so those that still wait are ones that the peer does not read.
    static_cast<void>(Flush());
    if (phase_ != Phase::kOpen || !grpc_->http2().flooded()) continue;
    grpc_->EndFlood();
    break;
  }
  if (tls_->over()) OnReceiveEnd();
}

void Connection::OnReceiveEnd() {
  thread_.clock.Advance();
  // The handshake was in vain, unless we turned the peer away.
  if (phase_ == Phase::kHandshake && tls_->begun()) FailHandshake(TurnedAway::kHandshakeError);
  if (phase_ == Phase::kOpen && !grpc_->ends() && !grpc_->served() && !grpc_->answered()) {
    thread_.book.Note(TurnedAway::kNoStream, origin_, thread_.clock.Steady());
  }
  CloseFor(CauseOfReceiveEnd());
}

Turn Connection::turn() const {
  if (phase_ != Phase::kHandshake) return Turn::kNow;
  if (origin_.own) return Turn::kOwnHandshake;
  return origin_.known ? Turn::kKnownHandshake : Turn::kHandshake;
}

void Connection::FailHandshake(TurnedAway cause) {
  thread_.debug.HandshakeFailed(id_, origin_,
                                transport::kTurnedAwayTexts[static_cast<std::size_t>(cause)]);
  thread_.book.NoteFailedHandshake(cause, tls_->detail(), origin_, thread_.clock.Steady());
}

// --- What is said ---

void Connection::Settle() {
  if (phase_ == Phase::kClosed) return;
  do {
    if (grpc_ != nullptr) grpc_->SettleCalls();
  } while (Flush() || (grpc_ != nullptr && !grpc_->settled()));
  EndIfDone();
  if (phase_ == Phase::kClosed) return;
  const bool goes = grpc_ != nullptr && grpc_->ends();
  lifetime_.SetBlocked(socket_.blocked(), goes ? kAgeGrace : kBlockedWait, thread_.clock.Steady());
  SetTimer();
}

bool Connection::Flush() {
  std::string& out = thread_.tls.out;
  bool good = true;
  while (good && phase_ == Phase::kOpen && !socket_.blocked() && out.size() < kSendBytesMax) {
    grpc_->http2().Gather(thread_.gathered, kRecordBytes);
    if (thread_.gathered.empty()) break;
    good = tls_->Write(thread_.gathered);
  }
  const bool something = !out.empty();
  if (something && phase_ != Phase::kClosed) good = socket_.Send(out) && good;
  out.clear();
  if (socket_.kept_bytes() > kKeptBytesMax) {
    thread_.book.Note(TurnedAway::kNotRead, origin_, thread_.clock.Steady());
    CloseFor(CauseOfBlocked());
  }
  if (!good) CloseFor(CauseOfReceiveEnd());
  return something && phase_ == Phase::kOpen && !socket_.blocked();
}

void Connection::EndIfDone() {
  if (phase_ != Phase::kOpen) return;
  if (grpc_->EndIfLast()) static_cast<void>(Flush());
  if (phase_ == Phase::kOpen && grpc_->http2().over()) Linger();
}

void Connection::Linger() {
  if (phase_ == Phase::kOpen) tls_->WriteEnd();
  static_cast<void>(Flush());
  if (phase_ == Phase::kClosed) return;
  const bool was_handshake = phase_ == Phase::kHandshake;
  // A peer that does not speak TLS cannot read an alert; and only so many descriptors may linger.
  if (tls_->failure() == TlsEngine::Failure::kNoTls) return Close();
  const auto key = grpc_ != nullptr ? std::optional(grpc_->tls_peer().key) : std::nullopt;
  if (!place_.Linger(key)) return Close();
  phase_ = Phase::kLinger;
  if (was_handshake) owner_.OnHandshakeEnded(*this);
  if (grpc_ != nullptr) grpc_->Break();
  // A peer that has not read everything gets the time to.
  const bool blocked = socket_.blocked();
  if (!blocked) socket_.EndOutput();
  phase_by_ = thread_.clock.Steady() + (blocked ? kAgeGrace : kLingerWait);
}

void Connection::Close() {
  if (phase_ == Phase::kClosed) return;
  const bool was_handshake = phase_ == Phase::kHandshake;
  phase_ = Phase::kClosed;
  // The bytes that TLS still wanted to send are this connection's, but the buffer is the thread's.
  thread_.tls.out.clear();
  if (grpc_ != nullptr) grpc_->Break();
  socket_.Close();
  place_.Leave();
  thread_.connection_timers.Forget(id_, timer_);
  thread_.debug.ConnectionClosed(id_, origin_);
  if (was_handshake) owner_.OnHandshakeEnded(*this);
  owner_.OnClosed(*this);
}

// --- When it ends, besides by its peer: time, a drain, and others ---

void Connection::Evict() {
  if (phase_ == Phase::kOpen) {
    grpc_->TurnAway(TurnedAway::kKey, "too many connections of this certificate");
    Settle();
    if (phase_ == Phase::kLinger) return;
  }
  // A connection that already lingered, or does not read, has had its place for long enough.
  Close();
}

void Connection::Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end,
                       EndCause cause) {
  if (phase_ == Phase::kHandshake) return Close();
  if (phase_ != Phase::kOpen) return;
  lifetime_.EndBy(end);
  grpc_->Drain(spread, first, end, cause);
  Settle();
}

void Connection::Shutdown() {
  if (phase_ == Phase::kOpen) {
    grpc_->connection().NoteEnd(EndCause::kServerStops);
    grpc_->End();
  }
  static_cast<void>(Flush());
  Close();
}

void Connection::OnTimer() {
  timer_.reset();
  const SteadyTime now = thread_.clock.Steady();
  if (phase_ == Phase::kHandshake) LookAtHandshake(now);
  if (phase_ == Phase::kLinger && now >= *phase_by_) return Close();
  if (phase_ == Phase::kOpen) LookAtLifetime(now);
  Settle();
}

void Connection::LookAtHandshake(SteadyTime now) {
  if (now < *phase_by_) return;
  if (now < handshake_by_ && !thread_.book.pressed()) {
    // No connection waits for its place: it may go on, and is checked again.
    phase_by_ = std::min(handshake_by_, now + kLookAgain);
    return;
  }
  FailHandshake(TurnedAway::kHandshakeTimeout);
  Close();
}

void Connection::LookAtLifetime(SteadyTime now) {
  switch (lifetime_.Take(now, thread_.book.pressed())) {
    case Lifetime::Due::kNothing:
      return;
    case Lifetime::Due::kPing:
      static_cast<void>(socket_.TakesSome());
      return grpc_->http2().Ping();
    case Lifetime::Due::kNotRead:
      thread_.book.Note(TurnedAway::kNotRead, origin_, now);
      return CloseFor(CauseOfBlocked());
    case Lifetime::Due::kSilent:
      // While our bytes wait, kNotRead judges how fast the peer takes them.
      if (socket_.blocked() || socket_.TakesSome()) return lifetime_.StillTakes(now);
      thread_.book.Note(TurnedAway::kSilent, origin_, now);
      return CloseFor(EndCause::kUnanswered);
    case Lifetime::Due::kAge:
      return Drain({calls(), now, kAgeGrace}, 0, now + kAgeGrace, EndCause::kAge);
    case Lifetime::Due::kExpired:
      return Drain({calls(), now, kAgeGrace}, 0, now + kAgeGrace, EndCause::kExpired);
    case Lifetime::Due::kOver:
      return grpc_->End();
    case Lifetime::Due::kIdle:
      grpc_->connection().NoteEnd(EndCause::kClosed);
      return grpc_->StopServing();
    case Lifetime::Due::kNoCall:
      if (grpc_->answered()) return grpc_->StopServing();
      return grpc_->TurnAway(TurnedAway::kNoStream, "no stream was opened");
    case Lifetime::Due::kLookAtExpiry:
      return lifetime_.SetExpiry(now, UntilExpiry());
  }
}

void Connection::SetTimer() {
  const SteadyTime now = thread_.clock.Steady();
  const SteadyTime at = phase_by_ ? *phase_by_ : lifetime_.next(now);
  thread_.connection_timers.Want(id_, timer_, at, now);
}

}  // namespace uplink::front
