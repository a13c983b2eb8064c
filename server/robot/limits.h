#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"
#include "server/limits/policies.h"

namespace uplink::robot {

/// Rejects that session memory remembers for the next Welcome (protocol: Numbers).
inline constexpr std::size_t kRejectsRememberedMax = 256;
/// Sessions of one robot in memory (protocol: Numbers).
inline constexpr std::size_t kSessionsMax = 8;
/// Malformed messages of a robot per second, over all its streams, and as many at once after a
/// pause; past them its stream is held back. The same of messages over their rate.
inline constexpr std::uint32_t kRejectsPerSecondMax =
    limits::PolicyOf(limits::PolicyId::kRejectsOfRobot).most;
/// So many follow at a time: less than one robot may have in a commit (journal::BatchShare).
inline constexpr std::uint32_t kRejectsAtOnce = 100;
/// What one jump of numbers adds to the count of missing ones, at most: an agent may jump by 2^32,
/// and at a stream's first message by more, so that one mistake would bury every honest count.
inline constexpr std::uint64_t kMissingPerJumpMax = std::uint64_t{1} << 20U;
/// A minute, its end included, for limits::RecentTimes.
inline constexpr SteadyTime::duration kMinute = std::chrono::minutes(1) + SteadyTime::duration(1);
/// Takeovers within a minute above which a robot is flagged as contested.
inline constexpr std::uint32_t kTakeoversPerMinuteMax =
    limits::PolicyOf(limits::PolicyId::kTakeoversOfRobot).most;
/// What a record that waits in the journal costs besides its payload and its body: the record, the
/// queue's node. A gap costs as much.
inline constexpr std::size_t kRecordOverheadBytes = 512;
/// Streams of one robot within a minute of which none waits.
inline constexpr std::uint32_t kStreamsPerMinuteMax =
    limits::PolicyOf(limits::PolicyId::kStreamsOfRobot).most;
/// How long the first one past that waits; each further one waits twice as long as the one before.
inline constexpr std::chrono::milliseconds kStreamDelayMin{100};
/// Longest wait of one stream.
inline constexpr std::chrono::milliseconds kStreamDelayMax{5'000};
/// Times of a robot's streams that are remembered: from as many on, each waits for the longest.
inline constexpr std::size_t kStreamTimesMax = kStreamsPerMinuteMax + 7;
static_assert(kStreamDelayMin * (1U << (kStreamTimesMax - kStreamsPerMinuteMax - 1)) >=
              kStreamDelayMax);
/// Streams of one robot that wait at once; one more is refused.
inline constexpr std::size_t kStreamsWaitingMax = 4;
/// A robot that calls here while another process has it is claimed anew at most once in this time:
/// that process may have let go of it.
inline constexpr std::chrono::seconds kClaimAgainEvery{5};
/// A robot is asked for a kind of message that the store lacks of it at most once in this time.
inline constexpr std::chrono::minutes kResendEvery{1};
/// Bytes of one part of a live state, in memory and in a checkpoint. Of a part with more, the keys
/// that were updated last are kept as far as they fit.
inline constexpr std::size_t kLivePartBytesMax = std::size_t{256} * 1024;
/// Distinct fields for which a robot's Notices are paced; further fields share one slot.
inline constexpr std::size_t kNoticeFieldsMax = 64;

}  // namespace uplink::robot
