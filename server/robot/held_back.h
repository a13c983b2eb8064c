#pragma once

#include <cstdint>
#include <string_view>

namespace uplink::robot {

/// Why no message of a robot's stream may be processed (protocol: Holding back).
enum class HeldBack : std::uint8_t {
  kNone,
  /// in_flight_uplinks_max of the robot's messages wait for commits.
  kInFlight,
  /// The journal is full.
  kJournal,
  /// The peer does not read.
  kUnread,
  /// Too many malformed messages in this second.
  kMalformed,
};

/// The word of the fleet contract (Robot.held_back); empty for kNone.
[[nodiscard]] std::string_view ToText(HeldBack by);

}  // namespace uplink::robot
