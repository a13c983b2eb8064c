#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/cyberwave/limits.h"
#include "server/limits/policies.h"

/// The bounds of one twin's state, and of what it may send.
namespace uplink::cyberwave {

/// Joint names of one source type, over all messages. Further ones are dropped.
inline constexpr std::size_t kJointNamesMax = 256;
static_assert(kJointsMax <= kJointNamesMax, "the joints of one message have room");
/// Sessions whose last time one value remembers; the one heard least recently is forgotten.
inline constexpr std::size_t kSessionsOfValueMax = 4;
/// Sessions whose marks are remembered; the one heard least recently is forgotten.
inline constexpr std::size_t kMarkedSessionsMax = 32;
/// Ended streams of one session; the one that ended first is forgotten.
inline constexpr std::size_t kEndedStreamsMax = 16;

// In these tables the least recently updated key is evicted.
inline constexpr std::size_t kMetricCategoriesMax = 64;
inline constexpr std::size_t kEdgesMax = 16;
inline constexpr std::size_t kReportsMax = 32;
/// Memory of one such table. The content of any one message has room.
inline constexpr std::size_t kTableBytesMax = std::size_t{512} * 1024;
static_assert(kTableBytesMax >= 8 * kMessageBytesMax);

/// Faults from metrics that are active at a time: those that the last metrics named.
inline constexpr std::size_t kMetricFaultsMax = kErrorsMax;
/// Records that one message may bring: faults that it raises, and faults that it clears.
inline constexpr std::size_t kRecordsOfMessageMax = 2 * kMetricFaultsMax;

/// What one twin may send.
inline constexpr limits::BucketSize kMessagesOfTwin =
    limits::PolicyOf(limits::PolicyId::kMessagesOfTwin).bucket();
inline constexpr limits::BucketSize kLogLinesOfTwin =
    limits::PolicyOf(limits::PolicyId::kLogLinesOfTwin).bucket();
inline constexpr limits::BucketSize kFaultChangesOfTwin =
    limits::PolicyOf(limits::PolicyId::kFaultChangesOfTwin).bucket();

/// Pongs in any second, to one name and to all names.
inline constexpr std::size_t kPongsOfNameMax =
    limits::PolicyOf(limits::PolicyId::kPongsOfName).most;
inline constexpr std::size_t kPongsMax = limits::PolicyOf(limits::PolicyId::kPongs).most;
/// Remembered names. Those that got a pong within the last second always have room.
inline constexpr std::size_t kPongNamesMax =
    limits::PolicyOf(limits::PolicyId::kPongsOfName).keys_max;
static_assert(kPongNamesMax >= 2 * kPongsMax);

}  // namespace uplink::cyberwave
