#include "tools/uplink-fleet/robot/mishap.h"

#include <chrono>
#include <utility>

namespace uplink::synthetic {

Mishap DrawMishap(const Phase& phase, std::mt19937_64& random) {
  using Minutes = std::chrono::duration<double, std::chrono::minutes::period>;
  const double minutes = Minutes(phase.tick()).count();
  double left = std::uniform_real_distribution<double>(0, 1)(random);
  for (const auto& [mishap, per_minute] :
       {std::pair(Mishap::kCut, phase.trouble.cuts_per_minute),
        std::pair(Mishap::kBreak, phase.trouble.breaks_per_minute),
        std::pair(Mishap::kHalfOpen, phase.trouble.half_opens_per_minute),
        std::pair(Mishap::kTakeover, phase.trouble.takeovers_per_minute)}) {
    left -= per_minute * minutes;
    if (left < 0) return mishap;
  }
  return Mishap::kNone;
}

}  // namespace uplink::synthetic
