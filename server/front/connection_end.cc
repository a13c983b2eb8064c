// When a connection ends, and what ends it besides its peer: time, a drain, and others.
#include <algorithm>
#include <utility>

#include <nghttp2/nghttp2.h>

#include "server/front/call/thread.h"
#include "server/front/connection.h"

namespace uplink::front {

using transport::TurnedAway;

void Connection::Evict() {
  if (phase_ == Phase::kOpen) {
    TurnAway(TurnedAway::kKey, "too many connections of this certificate");
    Settle();
    if (phase_ == Phase::kLinger) return;
  }
  // One that lingered before, or does not read what it is told, has had its place for long enough.
  Close();
}

void Connection::Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end) {
  if (phase_ == Phase::kHandshake) return Close();
  if (phase_ != Phase::kOpen) return;
  if (!std::exchange(ending_, true)) http2_->NoticeEnd();
  lifetime_.EndBy(end);
  calls_.Drain(spread, first, end);
  Settle();
}

void Connection::Shutdown() {
  if (phase_ == Phase::kOpen) http2_->End(NGHTTP2_NO_ERROR, "");
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
    // Nobody waits for its place: it may go on, and is looked at again.
    phase_by_ = std::min(handshake_by_, now + kLookAgain);
    return;
  }
  FailHandshake(TurnedAway::kHandshakeTimeout);
  Close();
}

milliseconds Connection::UntilExpiry() const {
  return peer_->UntilExpiry(thread_.clock.System(), thread_.relay.clock_trust.vouched());
}

void Connection::LookAtLifetime(SteadyTime now) {
  switch (lifetime_.Take(now, thread_.book.pressed())) {
    case Lifetime::Due::kNothing:
      return;
    case Lifetime::Due::kPing:
      static_cast<void>(socket_.TakesSome());
      return http2_->Ping();
    case Lifetime::Due::kNotRead:
      thread_.book.Note(TurnedAway::kNotRead, origin_, now);
      return Close();
    case Lifetime::Due::kSilent:
      // While bytes of ours are kept back, kNotRead judges how fast it takes them.
      if (socket_.blocked() || socket_.TakesSome()) return lifetime_.StillTakes(now);
      thread_.book.Note(TurnedAway::kSilent, origin_, now);
      return Close();
    case Lifetime::Due::kAge:
      return Drain({calls_.size(), now, kAgeGrace}, 0, now + kAgeGrace);
    case Lifetime::Due::kOver:
      return http2_->End(NGHTTP2_NO_ERROR, "");
    case Lifetime::Due::kIdle:
      ending_ = true;
      return;
    case Lifetime::Due::kNoCall:
      if (answered_) {
        ending_ = true;
        return;
      }
      return TurnAway(TurnedAway::kNoStream, "no stream was opened");
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
