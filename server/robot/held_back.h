#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::robot {

/// Why no message of a robot's stream may be processed (protocol: Holding back).
enum class HeldBack : std::uint8_t {
  kNone,
  /// in_flight_uplinks_max of the robot's messages wait for commits.
  kInFlight,
  /// The robot's share of the journal is full, or that of its gateway.
  kJournalShare,
  /// The journal is full, or its gateway has twice its share; and the next message is durable.
  kJournal,
  /// More is to be stored of the robot than its buckets allow (DurableFlow).
  kFlow,
  /// The store's disk is nearly full, and the robot is among those that fill it; or no robot may
  /// store anything.
  kDisk,
  /// The peer does not read.
  kUnread,
  /// Too many malformed messages of the robot per second.
  kMalformed,
};

/// kNone included.
inline constexpr std::size_t kHeldBackReasons = static_cast<std::size_t>(HeldBack::kMalformed) + 1;

/// The word of the fleet contract (Robot.held_back); empty for kNone.
[[nodiscard]] std::string_view ToText(HeldBack by);

/// Since when a robot's stream is held back. Flow and disk let it go on record by record: who is
/// held back again within kHeldBackAgain was so all the time. Confined to its owner.
class HeldBackTrack final {
 public:
  void Set(HeldBack by, SystemTime now);

  [[nodiscard]] HeldBack by() const { return by_; }
  /// Only while something holds it back.
  [[nodiscard]] SystemTime since() const { return since_; }

 private:
  HeldBack by_ = HeldBack::kNone;
  SystemTime since_;
  /// When it was let go on last.
  SystemTime let_go_at_;
};
inline constexpr std::chrono::seconds kHeldBackAgain{10};

}  // namespace uplink::robot
