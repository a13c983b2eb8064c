#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "storage/deliveries.h"

namespace uplink::broker {

/// The stream of a twin that was silent for so long ends, if nothing of it waits. The twin may then
/// leave memory, and begins a new session when it speaks.
inline constexpr std::chrono::hours kStreamIdleMax{1};
/// How often to close the streams of silent twins, forget twins whose robots left memory, and
/// check the client's certificate.
inline constexpr std::chrono::seconds kLookAtTwinsEvery{60};
/// How long reading at QoS 1 may be stopped before `behind` shows it.
inline constexpr std::chrono::seconds kUnreadAfter{1};
/// How long reading may stop repeatedly, or the window be full, before `behind` shows it.
inline constexpr std::chrono::seconds kBehindShownAfter{10};
/// If the broker's thread did not tick for so long, we learn nothing of twins.
inline constexpr std::chrono::seconds kTickLate{3};
/// Times cyberwave.robots_max: the faults of so many twins that left memory are remembered.
inline constexpr std::size_t kFaultsKeptShare = 2;
/// Payloads from this size on count as bytes at QoS 0 (limits::PolicyId::kBytesOfId): smaller ones
/// are read as fast as they are sent.
inline constexpr std::size_t kBudgetedBytesMin = 512;
/// After an operator ended a robot's stream, it is not opened again for so long, so that the robot
/// can be forgotten although it speaks.
inline constexpr std::chrono::seconds kRestAfterDrop{5};
/// So many unread bytes of the live connection in the kernel show that we are too slow for it.
inline constexpr std::size_t kLiveBehindBytes = std::size_t{128} * 1024;
/// A ping of the live connection without an answer for so long waits behind a queue in the broker:
/// the broker is too slow, or we are.
inline constexpr std::chrono::seconds kLivePingWaitMax{2};
/// How long every update may find either of them before we connect anew. By then the
/// broker's queue is full of messages that show long-gone twins as alive.
inline constexpr std::chrono::seconds kLiveBehindMax{10};
/// How long `behind` stays 1 after such a connection, so that a repetition is visible.
inline constexpr std::chrono::seconds kLiveBehindShown{60};
/// The window for which deliveries are remembered (storage::DeliveriesKept): the largest, whatever
/// mqtt.unacked_max is, since a broker may send far more than it was asked to. Once mosquitto
/// before 2.0.13 has a queue, it sends as many further messages with each PUBACK as the window has,
/// and while it sends it reads no PUBACK. After a kill all of them come again.
inline constexpr std::uint32_t kRememberedWindow = storage::kUnackedMaxMax;

}  // namespace uplink::broker
