#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::robot {

/// Why no message of a robot's stream may be processed (protocol: Holding back).
enum class HeldBack : std::uint8_t {
  kNone,
  /// in_flight_uplinks_max of the robot's messages wait for commits.
  kInFlight,
  /// The robot's share of the journal is full.
  kJournalShare,
  /// The journal is full, and the next message is durable.
  kJournal,
  /// More is to be stored of the robot than its buckets allow (DurableFlow).
  kFlow,
  /// The store's disk is nearly full, and the robot is among those that fill it; or no robot may
  /// store anything.
  kDisk,
  /// The peer does not read.
  kUnread,
  /// Too many malformed messages of the robot in this second.
  kMalformed,
};

/// kNone included.
inline constexpr std::size_t kHeldBackReasons = 8;

/// The word of the fleet contract (Robot.held_back); empty for kNone.
[[nodiscard]] std::string_view ToText(HeldBack by);

}  // namespace uplink::robot
