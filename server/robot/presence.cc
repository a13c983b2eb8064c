#include "server/robot/presence.h"

#include <algorithm>

namespace uplink::robot {

SteadyTime EndOfStallWithGrace(SteadyTime now, const PresenceLimits& limits) {
  return now + std::max(milliseconds(0), limits.startup_grace - limits.timeout);
}

SteadyTime NotOfflineUntil(const PresenceFacts& facts, const PresenceLimits& limits) {
  SteadyTime until = facts.known_since + limits.timeout;
  if (facts.last_sign_of_life) {
    until = *facts.last_sign_of_life + limits.timeout;
  } else {
    until = std::max(until, facts.server_started + limits.startup_grace);
    if (facts.unknown_until) until = std::max(until, *facts.unknown_until);
  }
  if (facts.claimed) until = std::max(until, facts.claimed->at + limits.timeout);
  if (facts.held_back_until) until = std::max(until, *facts.held_back_until + limits.timeout);
  return until;
}

Presence PresenceOf(const PresenceFacts& facts, const PresenceLimits& limits) {
  if (facts.last_sign_of_life && facts.now - *facts.last_sign_of_life <= limits.timeout) {
    return Presence::kOnline;
  }
  const auto& claimed = facts.claimed;
  if (claimed && claimed->presence == Presence::kOnline &&
      facts.now - claimed->at <= limits.timeout) {
    return Presence::kOnline;
  }
  // Silence that the server caused proves nothing.
  if (facts.held_back) return Presence::kUnknown;
  if (facts.held_back_until && facts.now - *facts.held_back_until <= limits.timeout) {
    return Presence::kUnknown;
  }
  if (claimed && claimed->presence == Presence::kOffline) return Presence::kOffline;
  if (!facts.last_sign_of_life && facts.unknown_until && facts.now <= *facts.unknown_until) {
    return Presence::kUnknown;
  }
  if (!facts.last_sign_of_life && (facts.now - facts.server_started <= limits.startup_grace ||
                                   facts.now - facts.known_since <= limits.timeout)) {
    return Presence::kUnknown;
  }
  return Presence::kOffline;
}

}  // namespace uplink::robot
