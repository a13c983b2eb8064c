#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/limits/policies.h"

/// The bounds of drones' calls. Those of content are in schema/uncrew/limits.h.
namespace uplink::uncrew {

/// Calls of one drone that wait for their answer; one more is RESOURCE_EXHAUSTED. Of waiting
/// samples there are as many at most.
inline constexpr std::size_t kCallsInFlightMax = 64;
/// Live samples of one drone per second, and at once; one more is RATE_LIMITED.
inline constexpr limits::BucketSize kLiveRate =
    limits::PolicyOf(limits::PolicyId::kLiveSamplesOfDrone).bucket();
/// A sample this much older by its boot time is of the same flight, and superseded; one that is
/// older still comes after a reboot.
inline constexpr std::chrono::seconds kOlderMax{60};
/// A drone that did not call for so long is held no more: until then its last place is shown.
inline constexpr std::chrono::hours kDroneIdleMax{24};
/// A durable sample for which there is no room is offered again after so long, and then each time
/// after twice the time, up to the second.
inline constexpr std::chrono::milliseconds kRoomAgain{50};
inline constexpr std::chrono::milliseconds kRoomAgainMax{1000};

}  // namespace uplink::uncrew
