#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "storage/deliveries.h"

namespace uplink::broker {

/// A twin that said nothing for so long, and of which nothing waits, has its stream ended: it may
/// leave memory then, and begins a new session when it speaks.
inline constexpr std::chrono::hours kStreamIdleMax{1};
/// How often twins are looked at that are silent, or came into the fleet by another way, and the
/// client's certificate.
inline constexpr std::chrono::seconds kLookAtTwinsEvery{60};
/// How long no message at QoS 1 may be read before it shows that we are behind.
inline constexpr std::chrono::seconds kUnreadAfter{1};
/// How long reading may stop again and again, or the window be full, before that is shown.
inline constexpr std::chrono::seconds kBehindShownAfter{10};
/// A broker's thread that did not tick for so long hears nobody.
inline constexpr std::chrono::seconds kTickLate{3};
/// Twins whose faults are remembered while they are not in memory, for each that may be.
inline constexpr std::size_t kFaultsKeptShare = 2;
/// Payloads that count as bytes at QoS 0 (limits::PolicyId::kBytesOfId): smaller ones take no
/// longer to read than to send.
inline constexpr std::size_t kBudgetedBytesMin = 512;
/// How long a robot's stream is not opened anew that an operator ended, so that the robot can be
/// forgotten although it speaks.
inline constexpr std::chrono::seconds kRestAfterDrop{5};
/// What lies unread in the kernel of the live connection at a look where we are too slow for it.
inline constexpr std::size_t kLiveBehindBytes = std::size_t{128} * 1024;
/// A ping of that connection without an answer for so long is behind what waits in the broker: then
/// the broker is too slow, or we are.
inline constexpr std::chrono::seconds kLivePingWaitMax{2};
/// How long each look may find the one or the other before the connection is made anew. As much as
/// its queue takes waits in the broker then, and each message of it says of a twin that may be long
/// gone that it lives.
inline constexpr std::chrono::seconds kLiveBehindMax{10};
/// How long that is shown, so that it is in sight where it happens again and again.
inline constexpr std::chrono::seconds kLiveBehindShown{60};
/// The window for which deliveries are remembered (storage::DeliveriesKept), whatever
/// mqtt.unacked_max is: the largest. A broker may send far more than it was asked to. mosquitto
/// before 2.0.13 does so once it has a queue, as many further messages with each PUBACK as the
/// window has, and while it sends it reads no PUBACK. All of that comes again after a kill.
inline constexpr std::uint32_t kRememberedWindow = storage::kUnackedMaxMax;

}  // namespace uplink::broker
