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
  /// The robot's share of the journal is full, or its gateway's.
  kJournalShare,
  /// The next message is durable, and the journal is full or the gateway has twice its share.
  kJournal,
  /// The robot stores more than its buckets allow (DurableFlow).
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

/// Since when a robot's stream is held back. Flow and disk release it record by record, so a stream
/// that is held back again within kHeldBackAgain counts as held back throughout. Confined to its
/// owner.
class HeldBackTrack final {
 public:
  void Set(HeldBack by, SystemTime now);

  [[nodiscard]] HeldBack by() const { return by_; }
  /// Only while something holds it back.
  [[nodiscard]] SystemTime since() const { return since_; }

 private:
  HeldBack by_ = HeldBack::kNone;
  SystemTime since_;
  /// When it was last released.
  SystemTime let_go_at_;
};
inline constexpr std::chrono::seconds kHeldBackAgain{10};

}  // namespace uplink::robot
