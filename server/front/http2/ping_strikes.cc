#include "server/front/http2/ping_strikes.h"

namespace uplink::front {

PingStrikes::Verdict PingStrikes::OnPing(SteadyTime now) {
  const bool strike = pinged_ && now - last_ping_ < kPingGap;
  last_ping_ = now;
  pinged_ = true;
  if (!strike) return Verdict::kInOrder;
  if (strikes_ <= kStrikesMax) ++strikes_;
  return strikes_ > kStrikesMax ? Verdict::kTooMany : Verdict::kForgiven;
}

void PingStrikes::OnSent() {
  pinged_ = false;
  strikes_ = 0;
}

}  // namespace uplink::front
