#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/config/config.h"
#include "server/robot/limits.h"
#include "server/robot/reconnects.h"
#include "storage/bounds.h"
#include "storage/rejects.h"

namespace uplink::session {

/// Messages after which an Ack is sent if only live messages moved it (protocol: Ack). An ack for
/// each paced message would be a third of its cost (measured).
inline constexpr std::uint32_t kAckMessages = 64;
/// Frames that may wait for a peer to read; past them its stream is held back.
inline constexpr std::size_t kOutgoingFramesMax = 1024;
/// A stream without its first frame ends after this, since it holds a place among the streams.
inline constexpr std::chrono::seconds kHelloWait{10};
/// The same while others wait for a place.
inline constexpr std::chrono::seconds kHelloWaitPressed{3};
/// How often a stream between the two checks whether others wait.
inline constexpr std::chrono::seconds kHelloLook{1};
/// Longest that Welcome waits for the store (protocol: Hello and Welcome).
inline constexpr std::chrono::seconds kWelcomeWait{1};
/// A peer that takes nothing for so long while its outgoing queue is full is ended.
inline constexpr std::chrono::seconds kPeerStallMax{30};
/// A call that has ended, and whose peer does not read its status, is cancelled after this.
inline constexpr std::chrono::seconds kFinishWait{1};
/// After so many rejected, limited or partly invalid messages a stream lets others of its thread go
/// first: such a message takes up to 40 us, a good one half a microsecond.
inline constexpr std::size_t kCostlyPerTurn = 16;
/// Writes of forwards in one turn of a stream, before others of its thread go first.
inline constexpr std::size_t kForwardsPerTurn = 16;
/// After how long a failed read of Rejects is tried again.
inline constexpr std::chrono::seconds kRejectsReadAgain{1};
/// How long after Welcome an agent is first asked for messages that the store lacks. By then most
/// agents have sent them unasked: that takes a round trip over a mobile link, and the time to make
/// the message.
inline constexpr std::chrono::seconds kResendGrace{1};
/// Largest jump of numbers, except at a stream's first message.
inline constexpr std::uint64_t kSeqJumpMax = std::uint64_t{1} << 32U;
/// Arrivals that a stream keeps for the ack latency until its next Ack is written.
inline constexpr std::size_t kReleasedMax = 4096;

static_assert(robot::kRejectsRememberedMax + storage::kOpenRejectsMax <= kOutgoingFramesMax &&
                  storage::kRejectPageMax < kOutgoingFramesMax,
              "what is told again at once, and each page after it, must fit the outgoing queue");

/// The configurable limits of a session, each far below 2^32; Welcome tells the agent the same
/// numbers. Immutable.
struct SessionLimits {
  std::uint32_t payload_bytes_max =
      static_cast<std::uint32_t>(config::LimitsConfig().payload_bytes_max);
  std::uint32_t message_bytes_max =
      static_cast<std::uint32_t>(config::LimitsConfig().message_bytes_max);
  std::uint32_t batch_uplinks_max =
      static_cast<std::uint32_t>(config::LimitsConfig().batch_uplinks_max);
  std::uint32_t extras_items_max =
      static_cast<std::uint32_t>(config::LimitsConfig().extras_items_max);
  std::uint32_t in_flight_uplinks_max =
      static_cast<std::uint32_t>(config::LimitsConfig().in_flight_uplinks_max);
  std::uint32_t frame_bytes_max =
      static_cast<std::uint32_t>(config::LimitsConfig().frame_bytes_max);
  /// Whether an RCAN Robot State is a sign of life (rcan.counts_as_life).
  bool rcan_counts_as_life = config::RcanConfig().counts_as_life;
  /// So many unconfirmed Rejects of a session (above Hello.settled_seq) end its stream: each is in
  /// the store, and is read for the next Welcome.
  std::size_t unconfirmed_rejects_max = storage::kQuarantineRowsPerRobotMax;
  robot::ReconnectLimits reconnects;
  /// Rejects that come with the store's answer to an opening, and those of each page after it.
  std::size_t open_rejects_max = storage::kOpenRejectsMax;
  std::size_t reject_page_max = storage::kRejectPageMax;
  std::chrono::milliseconds ack_interval = config::LimitsConfig().ack_interval;
  std::chrono::milliseconds session_idle = config::LimitsConfig().session_idle;
  std::chrono::milliseconds drain_timeout = config::DrainConfig().timeout;
  std::string server_version;
};

}  // namespace uplink::session
