#include "server/front/lifetime.h"

#include <algorithm>

#include "server/front/http2/limits.h"

namespace uplink::front {
namespace {

/// If the expiry moved further than this since the last look, the civil clock was set; slewing
/// moves it by far less.
constexpr std::chrono::seconds kClockWasSet{10};

/// `span` less up to a tenth, so that robots which came together do not leave together.
milliseconds Shortened(milliseconds span, std::uint16_t jitter) {
  constexpr milliseconds::rep kParts = 65'536;
  return span - span / 10 * milliseconds::rep{jitter} / kParts;
}

/// How long before its certificates' expiry a connection ends, if so much is left when it opens.
milliseconds BeforeExpiry(milliseconds until_expiry, std::uint16_t jitter) {
  // With a certificate near its expiry it may stay until then: a robot that comes back with the
  // same one has no other, and would only be ended again.
  if (until_expiry <= kNearlyOver) return milliseconds(0);
  return until_expiry - Shortened(until_expiry - milliseconds(kBeforeExpiry), jitter);
}

}  // namespace

void Lifetime::Open(SteadyTime now, milliseconds age, milliseconds until_expiry,
                    std::uint16_t jitter) {
  opened_at_ = heard_at_ = now;
  empty_since_ = now;
  jitter_ = jitter;
  old_at_.reset();
  if (age > milliseconds(0)) old_at_ = now + Shortened(age, jitter);
  look_at_ = now;
  expires_at_.reset();
  SetExpiry(now, until_expiry);
}

void Lifetime::SetExpiry(SteadyTime now, milliseconds until_expiry) {
  if (!look_at_) return;
  look_at_ = now + kExpiryLook;
  const SteadyTime expires_at = now + until_expiry;
  if (!expires_at_ || std::chrono::abs(expires_at - *expires_at_) > kClockWasSet) {
    before_expiry_ = BeforeExpiry(until_expiry, jitter_);
  }
  expires_at_ = expires_at;
  const SteadyTime at = expires_at - before_expiry_;
  age_at_ = old_at_ ? std::min<SteadyTime>(*old_at_, at) : at;
}

void Lifetime::NoteHeard(SteadyTime now) {
  heard_at_ = now;
  answer_by_.reset();
}

void Lifetime::StillTakes(SteadyTime now) {
  if (answer_by_) answer_by_ = now + kKeepaliveWait;
}

void Lifetime::SetCalls(std::size_t calls, SteadyTime now) {
  if (calls > 0) {
    empty_since_.reset();
  } else if (!empty_since_) {
    // Calls that were not served earn no time.
    empty_since_ = had_call_ ? now : opened_at_;
  }
}

void Lifetime::SetBlocked(bool blocked, std::chrono::seconds wait, SteadyTime now) {
  if (!blocked) return blocked_by_.reset();
  blocked_by_ = blocked_by_ ? std::min<SteadyTime>(*blocked_by_, now + wait) : now + wait;
}

Lifetime::Due Lifetime::Take(SteadyTime now, bool pressed) {
  if (blocked_by_ && now >= *blocked_by_) return Due::kNotRead;
  if (answer_by_) {
    if (now >= *answer_by_) return Due::kSilent;
  } else if (now >= heard_at_ + kKeepaliveAfter) {
    answer_by_ = now + kKeepaliveWait;
    return Due::kPing;
  }
  if (ends_by_ && now >= *ends_by_) {
    ends_by_.reset();
    return Due::kOver;
  }
  if (age_at_ && now >= *age_at_) {
    age_at_.reset();
    look_at_.reset();
    return expires_at_ && now >= *expires_at_ ? Due::kExpired : Due::kAge;
  }
  if (look_at_ && now >= *look_at_) {
    look_at_ = now + kExpiryLook;
    return Due::kLookAtExpiry;
  }
  if (!empty_since_) return Due::kNothing;
  const auto first = pressed ? kFirstStreamWaitPressed : kFirstStreamWait;
  const auto wait = had_call_ ? SteadyTime::duration(kIdleWait) : first;
  if (now < *empty_since_ + wait) return Due::kNothing;
  empty_since_ = now;
  return had_call_ ? Due::kIdle : Due::kNoCall;
}

SteadyTime Lifetime::next(SteadyTime now) const {
  SteadyTime next = answer_by_ ? *answer_by_ : heard_at_ + kKeepaliveAfter;
  if (age_at_) next = std::min(next, *age_at_);
  if (look_at_) next = std::min(next, *look_at_);
  if (ends_by_) next = std::min(next, *ends_by_);
  if (blocked_by_) next = std::min(next, *blocked_by_);
  if (empty_since_) next = std::min(next, EmptyUntil(now));
  return next;
}

SteadyTime Lifetime::EmptyUntil(SteadyTime now) const {
  if (had_call_) return *empty_since_ + kIdleWait;
  const SteadyTime pressed = *empty_since_ + kFirstStreamWaitPressed;
  // From then on it may stay only while no connection waits.
  return now < pressed ? pressed : std::min(now + kLookAgain, *empty_since_ + kFirstStreamWait);
}

}  // namespace uplink::front
