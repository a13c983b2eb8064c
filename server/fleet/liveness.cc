#include "server/fleet/liveness.h"

namespace uplink::fleet {

Liveness::Liveness(const Clock& clock, const metrics::Cell& streams_total)
    : clock_(clock),
      streams_total_(streams_total),
      last_(clock.Steady()),
      streams_seen_(streams_total.value()) {}

void Liveness::BeginListening() {
  const std::lock_guard lock(mutex_);
  last_ = clock_.Steady();
}

void Liveness::NoteAsked() {
  const std::lock_guard lock(mutex_);
  if (!asked_) asked_ = clock_.Steady();
}

void Liveness::NoteHandshake() {
  const std::lock_guard lock(mutex_);
  last_ = clock_.Steady();
  if (!asked_) return;
  const SteadyTime::duration took = last_ - *asked_;
  late_ = took > (late_ ? kCaughtUpWithin : kBehindAfter);
  asked_.reset();
}

void Liveness::NoteStandstill() {
  const std::lock_guard lock(mutex_);
  ++standstills_;
  late_ = true;
  asked_.reset();
}

std::int64_t Liveness::standstills() const {
  const std::lock_guard lock(mutex_);
  return standstills_;
}

bool Liveness::behind() const {
  const std::lock_guard lock(mutex_);
  return late_ || (asked_ && clock_.Steady() - *asked_ > kBehindAfter);
}

milliseconds Liveness::age() const {
  const SteadyTime now = clock_.Steady();
  const std::int64_t streams = streams_total_.value();
  const std::lock_guard lock(mutex_);
  if (streams != streams_seen_) {
    streams_seen_ = streams;
    last_ = now;
  }
  return std::chrono::duration_cast<milliseconds>(now - last_);
}

}  // namespace uplink::fleet
