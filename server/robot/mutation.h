#pragma once

#include <cstdint>

namespace uplink::robot {

/// Faults that the simulation and the crash campaign plant, one at a time, to show that they would
/// find them.
enum class Mutation : std::uint8_t {
  kNone,
  /// An Ack goes out before the commit.
  kAckBeforeCommit,
  /// A Reject is not told again after Welcome.
  kRejectNotRepeated,
  /// A settlement leaves the window but changes no column of the conservation law.
  kSettleLost,
  /// A duplicate that was settled long ago gets no Ack.
  kDuplicateNotAcked,
  /// Acks do not wait for the Rejects that are read by pages.
  kPagesNotAwaited,
  /// A durable message over its rate is settled at once, and its Reject lies in memory alone.
  kLimitedNotStored,
  /// A robot that was offline is unknown after a restart.
  kOfflineForgotten,
  /// A process goes on to judge a robot after it learned that another one holds it.
  kFenceKeepsState,
  /// A broker's message is acked on arrival, before the commit.
  kMessageAckedOnArrival,
  /// A drone's sample is answered on arrival, before the commit.
  kSampleAnsweredEarly,
  /// A message that a broker delivers again counts as new.
  kRedeliveryForgotten,
  /// After a new connection, the store counts as having everything that it confirmed before.
  kReconnectTrusted,
  /// A settled message that a broker delivers again is acked without a look at the store.
  kSettledAckedFromMemory,
  /// The bytes of an incomplete frame are signs of life without a time limit.
  kSlowFrameUnbounded,
  /// Waiting samples of a drone that another server claims count as committed.
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
