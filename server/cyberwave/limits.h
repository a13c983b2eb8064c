#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/cyberwave/limits.h"
#include "server/limits/policies.h"

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

/// What one twin may send.
inline constexpr limits::BucketSize kMessagesOfTwin =
    limits::PolicyOf(limits::PolicyId::kMessagesOfTwin).bucket();
inline constexpr limits::BucketSize kLogLinesOfTwin =
    limits::PolicyOf(limits::PolicyId::kLogLinesOfTwin).bucket();
inline constexpr limits::BucketSize kFaultChangesOfTwin =
    limits::PolicyOf(limits::PolicyId::kFaultChangesOfTwin).bucket();

/// Pongs in any second, to one name and to all.
inline constexpr std::size_t kPongsOfNameMax =
    limits::PolicyOf(limits::PolicyId::kPongsOfName).most;
inline constexpr std::size_t kPongsMax = limits::PolicyOf(limits::PolicyId::kPongs).most;
/// Names that are remembered. Those that got a pong within the last second always have room.
inline constexpr std::size_t kPongNamesMax =
    limits::PolicyOf(limits::PolicyId::kPongsOfName).keys_max;
static_assert(kPongNamesMax >= 2 * kPongsMax);

}  // namespace uplink::cyberwave
