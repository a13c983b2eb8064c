#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "schema/model/presence.h"
#include "server/config/config.h"
#include "server/robot/flaps.h"

namespace uplink::robot {

using model::Presence;

/// The configured limits of presence, of the relay's robots or of twins. Immutable.
struct PresenceLimits {
  /// A sign of life at most this old means online (presence.timeout,
  /// cyberwave.presence_timeout).
  milliseconds timeout = config::PresenceConfig().timeout;
  /// How long after a start a robot that was not heard is unknown (presence.startup_grace).
  milliseconds startup_grace = config::PresenceConfig().startup_grace;
  /// How long a robot is parked at most (presence.parked_max).
  milliseconds parked_max = config::PresenceConfig().parked_max;
  Flaps::Limits flaps{};
};

/// All that presence depends on, on the server's monotonic clock.
struct PresenceFacts {
  SteadyTime now;
  SteadyTime server_started;
  /// When this process first knew the robot: at its first Hello, or from the store at the start.
  SteadyTime known_since;
  /// Empty if it was not heard since the server started.
  std::optional<SteadyTime> last_sign_of_life;
  /// The server does not read its stream now.
  bool held_back = false;
  /// When it last resumed reading, after holding back or being behind. In the future while it makes
  /// a stream of the robot wait.
  std::optional<SteadyTime> held_back_until;
  /// The presence that another process gave a robot that came here by a stream, and when it came;
  /// until it is heard here. Its online counts as a sign of life then; its offline lasts until a
  /// sign of life.
  struct Claimed {
    Presence presence = Presence::kUnknown;
    SteadyTime at;
  };
  std::optional<Claimed> claimed;
  /// If it was adopted: until when it may be silent and is unknown.
  std::optional<SteadyTime> unknown_until;
};

/// The end of a stall that makes a robot that is silent from `now` on unknown for
/// limits.startup_grace; after a stall it is unknown for limits.timeout anyway.
[[nodiscard]] SteadyTime EndOfStallWithGrace(SteadyTime now, const PresenceLimits& limits);

/// Until when a robot that is not held back cannot become offline if it stays silent. Meaningless
/// for a robot that came as offline.
[[nodiscard]] SteadyTime NotOfflineUntil(const PresenceFacts& facts, const PresenceLimits& limits);

/// The robot's presence: a pure function. A stream that opens or closes changes nothing.
[[nodiscard]] Presence PresenceOf(const PresenceFacts& facts, const PresenceLimits& limits);

}  // namespace uplink::robot
