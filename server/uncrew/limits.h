#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/limits/policies.h"

/// The bounds of drones' calls. Those of content are in schema/uncrew/limits.h.
namespace uplink::uncrew {

/// Calls of one drone that wait for their answer; one more is RESOURCE_EXHAUSTED. At most as many
/// samples wait.
inline constexpr std::size_t kCallsInFlightMax = 64;
/// Live samples of one drone per second, and at once; one more is RATE_LIMITED.
inline constexpr limits::BucketSize kLiveRate =
    limits::PolicyOf(limits::PolicyId::kLiveSamplesOfDrone).bucket();
/// A sample that is older by at most this, by its boot time, is of the same flight, and superseded.
/// If its boot time is smaller still, the drone has rebooted.
inline constexpr std::chrono::seconds kOlderMax{60};
/// A drone that did not call for so long is dropped. Until then its last position is shown.
inline constexpr std::chrono::hours kDroneIdleMax{24};
/// A durable sample without room is offered again after this time, which doubles each time up to
/// kRoomAgainMax.
inline constexpr std::chrono::milliseconds kRoomAgain{50};
inline constexpr std::chrono::milliseconds kRoomAgainMax{1000};

}  // namespace uplink::uncrew
