#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"
#include "server/limits/policies.h"

namespace uplink::robot {

/// Rejects that a session remembers for the next Welcome (protocol: Numbers).
inline constexpr std::size_t kRejectsRememberedMax = 256;
/// Sessions of one robot in memory (protocol: Numbers).
inline constexpr std::size_t kSessionsMax = 8;
/// Malformed messages of a robot per second, over all its streams, and as many at once after a
/// pause; past them its stream is held back. The same for messages over their rate.
inline constexpr std::uint32_t kRejectsPerSecondMax =
    limits::PolicyOf(limits::PolicyId::kRejectsOfRobot).most;
/// Past that, so many are released at a time: less than one robot may have in a commit
/// (journal::BatchShare).
inline constexpr std::uint32_t kRejectsAtOnce = 100;
/// Most missing numbers that one jump counts. An agent may jump by 2^32, and by more at a stream's
/// first message, so one mistake would bury every real count.
inline constexpr std::uint64_t kMissingPerJumpMax = std::uint64_t{1} << 20U;
/// A minute, including its end, for limits::RecentTimes.
inline constexpr SteadyTime::duration kMinute = std::chrono::minutes(1) + SteadyTime::duration(1);
/// Takeovers within a minute above which a robot is flagged as contested.
inline constexpr std::uint32_t kTakeoversPerMinuteMax =
    limits::PolicyOf(limits::PolicyId::kTakeoversOfRobot).most;
/// Memory of a waiting record beside its payload and its body: the record and the queue's node. A
/// gap takes as much.
inline constexpr std::size_t kRecordOverheadBytes = 512;
/// Streams of one robot within a minute that do not wait.
inline constexpr std::uint32_t kStreamsPerMinuteMax =
    limits::PolicyOf(limits::PolicyId::kStreamsOfRobot).most;
/// How long the first stream past that waits; each further one waits twice as long as the last.
inline constexpr std::chrono::milliseconds kStreamDelayMin{100};
/// Longest wait of one stream.
inline constexpr std::chrono::milliseconds kStreamDelayMax{5'000};
/// Remembered times of a robot's streams: from that many on, each waits for the longest.
inline constexpr std::size_t kStreamTimesMax = kStreamsPerMinuteMax + 7;
static_assert(kStreamDelayMin * (1U << (kStreamTimesMax - kStreamsPerMinuteMax - 1)) >=
              kStreamDelayMax);
/// Streams of one robot that wait at once; one more is refused.
inline constexpr std::size_t kStreamsWaitingMax = 4;
/// How often a robot that calls here while another process has it is claimed anew at most: that
/// process may have let go of it.
inline constexpr std::chrono::seconds kClaimAgainEvery{5};
/// How often a robot is asked at most for a kind of message that the store lacks.
inline constexpr std::chrono::minutes kResendEvery{1};
/// Bytes of one part of a live state, in memory and in a checkpoint. A part with more keeps the
/// most recently updated keys that fit.
inline constexpr std::size_t kLivePartBytesMax = std::size_t{256} * 1024;
/// Distinct fields for which a robot's Notices are paced; further fields share one slot.
inline constexpr std::size_t kNoticeFieldsMax = 64;

}  // namespace uplink::robot
