#pragma once

#include <cstdint>

namespace uplink::robot {

/// Mutations that the simulation and the crash campaign plant one at a time, to show that it would
/// find them.
enum class Mutation : std::uint8_t {
  kNone,
  /// An Ack goes out before the commit.
  kAckBeforeCommit,
  /// A Reject is not told again after Welcome.
  kRejectNotRepeated,
  /// A settlement leaves the window but no column of the conservation law.
  kSettleLost,
  /// A duplicate that was settled long ago gets no Ack.
  kDuplicateNotAcked,
  /// Acks do not wait for the Rejects that are read by pages.
  kPagesNotAwaited,
  /// A durable message over its rate is settled at once, and its Reject lies in memory alone.
  kLimitedNotStored,
  /// A robot that was offline is unknown after a restart.
  kOfflineForgotten,
  /// A process that learns that another one holds a robot goes on to judge it.
  kFenceKeepsState,
  /// A broker's message is acked when it came, before the commit.
  kMessageAckedOnArrival,
  /// A drone's sample is answered when it was taken, before the commit.
  kSampleAnsweredEarly,
  /// A message that a broker delivers again counts as new.
  kRedeliveryForgotten,
  /// Whatever store was connected to anew counts as having all that was told before.
  kReconnectTrusted,
  /// What a broker delivers again after it was settled is acked without a look at the store.
  kSettledAckedFromMemory,
  /// The bytes of a frame that is not whole are signs of life for as long as they come.
  kSlowFrameUnbounded,
  /// What waits while another server claims the drone counts as committed.
  kFencedSampleAnswered,
  /// A claim does not bring what the store remembers of the drone's samples.
  kClaimMemoryForgotten,
};

#ifdef UPLINK_MUTATIONS
/// The planted fault; only in a build that is linked with a definition of it.
[[nodiscard]] bool Planted(Mutation mutation);
#else
[[nodiscard]] constexpr bool Planted(Mutation /*mutation*/) { return false; }
#endif

}  // namespace uplink::robot
