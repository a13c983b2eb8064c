#include "server/front/door/handshake_rates.h"

#include <algorithm>

namespace uplink::front {
namespace {

/// The time that one handshake uses up.
constexpr std::chrono::milliseconds kEach{1000 / kHandshakesPerSecond};
constexpr std::chrono::milliseconds kBurst = kEach * kHandshakesAtOnce;

}  // namespace

void HandshakeRates::Note(const SourceAddress& source, SteadyTime now) {
  SteadyTime& idle_at = idle_at_.Touch(source);
  // Handshakes over the rate that no other source wanted do not count against it any longer.
  idle_at = std::min(std::max(idle_at, now) + kEach, now + kBurst + kEach);
  idle_at_.ForgetWhile([now](SteadyTime each) { return each <= now; });
}

SteadyTime HandshakeRates::WithinAt(const SourceAddress& source, SteadyTime now) const {
  const SteadyTime* const idle_at = idle_at_.Find(source);
  return idle_at == nullptr ? now : *idle_at - kBurst + kEach;
}

}  // namespace uplink::front
