#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "storage/deliveries.h"

namespace uplink::broker {

/// A twin that said nothing for so long, and of which nothing waits, has its stream ended: it may
/// leave memory then, and begins a new session when it speaks.
inline constexpr std::chrono::hours kStreamIdleMax{1};
/// How often twins are looked at that are silent, or came into the fleet by another way.
inline constexpr std::chrono::seconds kLookAtTwinsEvery{60};
/// How long no message at QoS 1 may be read before it shows that we are behind.
inline constexpr std::chrono::seconds kUnreadAfter{1};
/// How long reading may stop again and again, or the window be full, before that is shown.
inline constexpr std::chrono::seconds kBehindShownAfter{10};
/// A broker's thread that did not tick for so long hears nobody.
inline constexpr std::chrono::seconds kTickLate{3};
/// Twins whose faults are remembered while they are not in memory, for each that may be.
inline constexpr std::size_t kFaultsKeptShare = 2;
/// The window for which deliveries are remembered (storage::DeliveriesKept), whatever
/// mqtt.unacked_max is: the largest. A broker may send far more than it was asked to. mosquitto
/// before 2.0.13 does so once it has a queue, as many further messages with each PUBACK as the
/// window has, and while it sends it reads no PUBACK. All of that comes again after a kill.
inline constexpr std::uint32_t kRememberedWindow = storage::kUnackedMaxMax;

}  // namespace uplink::broker
