#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::front {

/// A peer that is gone without a word is noticed within these two; robots' networks are bad.
inline constexpr std::chrono::seconds kKeepaliveAfter{25};
inline constexpr std::chrono::seconds kKeepaliveWait{15};
/// How long a handshake may wait for its peer, and how long while others wait for a place.
inline constexpr std::chrono::seconds kHandshakeWait{20};
inline constexpr std::chrono::seconds kHandshakeWaitPressed{5};
/// How long a connection may be without its first stream while others wait.
inline constexpr std::chrono::seconds kFirstStreamWaitPressed{3};
/// How often a connection past its pressed wait is checked again.
inline constexpr std::chrono::seconds kLookAgain{1};
/// A connection whose streams have all ended is closed after this.
inline constexpr std::chrono::minutes kIdleWait{5};
/// How long we read on after our last word, so that no reset destroys it on its way.
inline constexpr std::chrono::seconds kLingerWait{1};
/// How many reads of kSharedReadBytes we do in that time: as many as a handshake may take
/// (kHandshakeReadsMax). Without a bound a stranger's bytes cost 350 ms of CPU in that second
/// (measured).
inline constexpr std::size_t kLingerReadsMax = 128;
/// A peer that does not take what waits for it, kSendBytesMax at a time, within this is cut:
/// reading a byte now and then keeps its place no longer.
inline constexpr std::chrono::seconds kBlockedWait{40};
/// Streams of a connection that has reached its age have so long to settle.
inline constexpr std::chrono::seconds kAgeGrace{10};
/// How often what is left of a certificate is looked at: the civil clock may be set, or be vouched
/// for only then.
inline constexpr std::chrono::minutes kExpiryLook{1};
/// A connection ends so long before its certificate does.
inline constexpr std::chrono::minutes kBeforeExpiry{10};
/// Unless so little was left of it when the connection opened.
inline constexpr std::chrono::minutes kNearlyOver{2 * kBeforeExpiry};

/// When an open connection is asked whether its peer is there, and when it ends: silence, age, its
/// certificate's expiry, no calls. A value with no clock of its own; confined to its connection's
/// thread.
class Lifetime final {
 public:
  enum class Due : std::uint8_t {
    kNothing,
    /// Nothing was heard for long: ask.
    kPing,
    /// The peer did not answer.
    kSilent,
    /// It did not take what waited for it.
    kNotRead,
    /// Its age, or its certificate's: its calls are to settle.
    kAge,
    /// The time for that is over.
    kOver,
    /// It has had no call for long.
    kIdle,
    /// It never had a call that was served.
    kNoCall,
    /// What is left of its certificates may have changed with the civil clock: SetExpiry.
    kLookAtExpiry,
  };

  /// The connection opened. `age` is limits.connection_age_max, zero for never; `until_expiry` what
  /// is left of its certificates; of both a tenth at most is taken, by `jitter` of 65,536 parts,
  /// and of the latter once, however often SetExpiry looks again.
  void Open(SteadyTime now, milliseconds age, milliseconds until_expiry, std::uint16_t jitter);
  /// So much is left of its certificates now. Nothing once its age was told.
  void SetExpiry(SteadyTime now, milliseconds until_expiry);
  void NoteHeard(SteadyTime now);
  /// The peer takes what waits for it, though it says nothing: our question waits behind that.
  void StillTakes(SteadyTime now);
  /// A call of it was served: from then on it may be without one for long.
  void NoteServed() { had_call_ = true; }
  /// So many calls are open now.
  void SetCalls(std::size_t calls, SteadyTime now);
  /// Whether bytes wait for a peer that does not read, which it must take within `wait`; a shorter
  /// one counts from when it is named.
  void SetBlocked(bool blocked, std::chrono::seconds wait, SteadyTime now);
  /// It ends by then, whatever its calls do.
  void EndBy(SteadyTime end) { ends_by_ = end; }

  /// What is due, once each. `pressed`: others wait for a place.
  [[nodiscard]] Due Take(SteadyTime now, bool pressed);
  /// When Take may find something; the earliest.
  [[nodiscard]] SteadyTime next(SteadyTime now) const;

 private:
  /// When a connection without a call is looked at next.
  [[nodiscard]] SteadyTime EmptyUntil(SteadyTime now) const;

  SteadyTime opened_at_;
  SteadyTime heard_at_;
  /// The peer was asked whether it is there.
  std::optional<SteadyTime> answer_by_;
  std::optional<SteadyTime> blocked_by_;
  std::uint16_t jitter_ = 0;
  /// By limits.connection_age_max alone.
  std::optional<SteadyTime> old_at_;
  /// When its certificates expire, and how long before that it ends.
  std::optional<SteadyTime> expires_at_;
  SteadyTime::duration before_expiry_{};
  /// By that or its certificates, and when those are looked at next; nothing once it was told.
  std::optional<SteadyTime> age_at_;
  std::optional<SteadyTime> look_at_;
  std::optional<SteadyTime> ends_by_;
  /// Since when there has been no call; nothing while there is one.
  std::optional<SteadyTime> empty_since_;
  bool had_call_ = false;
};

}  // namespace uplink::front
