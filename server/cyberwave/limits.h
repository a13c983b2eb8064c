#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/cyberwave/limits.h"
#include "server/limits/token_bucket.h"

/// The bounds of what is held of one twin, and of what it may send.
namespace uplink::cyberwave {

/// Names of joints of one source type, over all messages. Further ones are dropped.
inline constexpr std::size_t kJointNamesMax = 256;
static_assert(kJointsMax <= kJointNamesMax, "the joints of one message have room");
/// Sessions of which one value remembers the last time; the one heard least recently goes.
inline constexpr std::size_t kSessionsOfValueMax = 4;
/// Sessions of which marks are remembered; the one heard least recently goes.
inline constexpr std::size_t kMarkedSessionsMax = 32;
/// Streams that ended, of one session; the one that ended first goes.
inline constexpr std::size_t kEndedStreamsMax = 16;

// Of these the key that was updated least recently goes.
inline constexpr std::size_t kMetricCategoriesMax = 64;
inline constexpr std::size_t kEdgesMax = 16;
inline constexpr std::size_t kReportsMax = 32;
/// Memory of one such table. Whatever one message says has room.
inline constexpr std::size_t kTableBytesMax = std::size_t{512} * 1024;
static_assert(kTableBytesMax >= 8 * kMessageBytesMax);

/// Faults from metrics that are active at a time: what the last metrics named.
inline constexpr std::size_t kMetricFaultsMax = kErrorsMax;
/// What one message may have stored: faults that are raised, and faults that are cleared.
inline constexpr std::size_t kRecordsOfMessageMax = 2 * kMetricFaultsMax;

/// What one twin may send, its simulated robot included.
inline constexpr limits::BucketSize kMessagesOfTwin{.rate = 1'000, .burst = 5'000};
inline constexpr limits::BucketSize kLogLinesOfTwin{.rate = 50, .burst = 2'000};
/// Faults that its metrics may raise and clear: one message of half a kilobyte may change 128, and
/// one twin would keep the store busy with nothing else. As many as log lines.
inline constexpr limits::BucketSize kFaultChangesOfTwin{.rate = 50, .burst = 2'000};

/// Pongs in any second, to one name and to all.
inline constexpr std::size_t kPongsOfNameMax = 10;
inline constexpr std::size_t kPongsMax = 1'000;
/// Names that are remembered. Those that got a pong within the last second always have room.
inline constexpr std::size_t kPongNamesMax = 2'048;
static_assert(kPongNamesMax >= 2 * kPongsMax);

}  // namespace uplink::cyberwave
