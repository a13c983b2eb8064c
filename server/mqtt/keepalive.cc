#include "server/mqtt/keepalive.h"

#include <algorithm>

namespace uplink::mqtt {

void Keepalive::ReadAgain(SteadyTime now) {
  if (reading_) return;
  reading_ = true;
  heard_ = now;
  waited_since_ = now;
}

SteadyTime Keepalive::PingAt() const {
  return (reading_ && !waiting_ ? asked_ : sent_) + interval_;
}

SteadyTime Keepalive::LateAt() const {
  if (!waiting_ || !reading_) return SteadyTime::max();
  return std::max(waited_since_, heard_) + wait_;
}

Keepalive::Due Keepalive::At(SteadyTime now) const {
  if (now >= LateAt()) return Due::kLate;
  return now >= PingAt() ? Due::kPing : Due::kNothing;
}

SteadyTime Keepalive::Next() const { return std::min(PingAt(), LateAt()); }

}  // namespace uplink::mqtt
