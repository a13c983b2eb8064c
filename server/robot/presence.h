#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "schema/model/presence.h"
#include "server/config/config.h"

namespace uplink::robot {

using model::Presence;

/// The configured limits of presence, of the relay's robots or of twins. Immutable.
struct PresenceLimits {
  /// A sign of life at most this old means online (presence.timeout,
  /// cyberwave.presence_timeout).
  milliseconds timeout = config::PresenceConfig().timeout;
  /// After a start a robot that was not heard is unknown for so long (presence.startup_grace).
  milliseconds startup_grace = config::PresenceConfig().startup_grace;
};

/// All that presence depends on, on the server's monotonic clock.
struct PresenceFacts {
  SteadyTime now;
  SteadyTime server_started;
  /// When this process came to know the robot: at its first Hello, or from the store at the start.
  SteadyTime known_since;
  /// Nothing if it was not heard since the server started.
  std::optional<SteadyTime> last_sign_of_life;
  /// The server does not read its stream now.
  bool held_back = false;
  /// When it last began to read again: after holding back, or when it had been behind itself. Ahead
  /// of now while it makes a stream of the robot wait.
  std::optional<SteadyTime> held_back_until;
  /// The robot came by a stream from a process that called it so, and was not heard here since:
  /// when it came. Its online counts as a sign of life then; its offline lasts until one.
  struct Claimed {
    Presence presence = Presence::kUnknown;
    SteadyTime at;
  };
  std::optional<Claimed> claimed;
  /// It was adopted: until when it may be unheard and is unknown.
  std::optional<SteadyTime> unknown_until;
};

/// Until when a stall has to last so that a robot that is not heard from `now` on is unknown for
/// limits.startup_grace: after a stall it is so for limits.timeout anyway.
[[nodiscard]] SteadyTime EndOfStallWithGrace(SteadyTime now, const PresenceLimits& limits);

/// Until when a robot that is not held back is not offline, if it is not heard any more; of one
/// that came as offline it means nothing.
[[nodiscard]] SteadyTime NotOfflineUntil(const PresenceFacts& facts, const PresenceLimits& limits);

/// Whether the robot is there: a pure function. A stream that opens or closes changes nothing.
[[nodiscard]] Presence PresenceOf(const PresenceFacts& facts, const PresenceLimits& limits);

}  // namespace uplink::robot
