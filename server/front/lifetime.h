#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::front {

/// We ping a peer that was silent for the first, and wait for its answer for the second. Together
/// they bound how long we do not notice that a peer is gone.
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
/// How long we read on after our last bytes, so that no reset destroys them on their way.
inline constexpr std::chrono::seconds kLingerWait{1};
/// How many reads of kSharedReadBytes we do in that time: as many as a handshake may take
/// (kHandshakeReadsMax). Without this bound, a stranger's bytes cost 350 ms of CPU in that second
/// (measured).
inline constexpr std::size_t kLingerReadsMax = 128;
/// A peer that does not take what waits for it, kSendBytesMax at a time, is cut after this. So
/// reading a byte now and then does not keep its place.
inline constexpr std::chrono::seconds kBlockedWait{40};
/// How long the streams of a connection that has reached its age have to settle.
inline constexpr std::chrono::seconds kAgeGrace{10};
/// How often the rest of a certificate's life is checked: the civil clock may be set, or become
/// vouched for.
inline constexpr std::chrono::minutes kExpiryLook{1};
/// A connection ends so long before its certificate does.
inline constexpr std::chrono::minutes kBeforeExpiry{10};
/// A connection that opens with less than this left of its certificate may stay until it expires.
inline constexpr std::chrono::minutes kNearlyOver{2 * kBeforeExpiry};

/// When an open connection is pinged, and when it ends: for silence, age, its certificate's expiry,
/// or no calls. A value with no clock of its own; confined to its connection's thread.
class Lifetime final {
 public:
  enum class Due : std::uint8_t {
    kNothing,
    /// The peer was silent for long: ping it.
    kPing,
    /// The peer did not answer.
    kSilent,
    /// It did not take what waited for it.
    kNotRead,
    /// It has reached its age, or its certificate expires soon: its calls must settle.
    kAge,
    /// Its certificate has expired: the same.
    kExpired,
    /// The time for settling is over.
    kOver,
    /// It has had no call for long.
    kIdle,
    /// It never had a served call.
    kNoCall,
    /// The civil clock may have changed what is left of its certificates: call SetExpiry.
    kLookAtExpiry,
  };

  /// The connection opened. `age` is limits.connection_age_max, zero for never; `until_expiry` what
  /// is left of its certificates. `jitter`, of 65,536 parts, takes up to a tenth off both; off the
  /// latter once, however often SetExpiry follows.
  void Open(SteadyTime now, milliseconds age, milliseconds until_expiry, std::uint16_t jitter);
  /// So much is left of its certificates now. No effect once kAge or kExpired was
  /// returned.
  void SetExpiry(SteadyTime now, milliseconds until_expiry);
  void NoteHeard(SteadyTime now);
  /// The peer is silent but takes what waits for it: our ping waits behind that.
  void StillTakes(SteadyTime now);
  /// A call was served: from now on it may be without one for long.
  void NoteServed() { had_call_ = true; }
  /// So many calls are open now.
  void SetCalls(std::size_t calls, SteadyTime now);
  /// Whether bytes wait for a peer that does not read, and must take them within `wait`. A shorter
  /// `wait` counts from this call.
  void SetBlocked(bool blocked, std::chrono::seconds wait, SteadyTime now);
  /// It ends by then, even if calls are open.
  void EndBy(SteadyTime end) { ends_by_ = end; }

  /// What is due, once each. `pressed`: other connections wait for a place.
  [[nodiscard]] Due Take(SteadyTime now, bool pressed);
  /// The earliest time at which Take may find something.
  [[nodiscard]] SteadyTime next(SteadyTime now) const;

 private:
  /// When a connection without a call is checked next.
  [[nodiscard]] SteadyTime EmptyUntil(SteadyTime now) const;

  SteadyTime opened_at_;
  SteadyTime heard_at_;
  /// The peer was asked whether it is there.
  std::optional<SteadyTime> answer_by_;
  std::optional<SteadyTime> blocked_by_;
  std::uint16_t jitter_ = 0;
  /// Set by limits.connection_age_max alone.
  std::optional<SteadyTime> old_at_;
  /// When its certificates expire, and how long before that it ends.
  std::optional<SteadyTime> expires_at_;
  SteadyTime::duration before_expiry_{};
  /// Set by old_at_ or its certificates, and when those are checked next; empty once kAge was
  /// returned.
  std::optional<SteadyTime> age_at_;
  std::optional<SteadyTime> look_at_;
  std::optional<SteadyTime> ends_by_;
  /// Since when there has been no call; empty while there is one.
  std::optional<SteadyTime> empty_since_;
  bool had_call_ = false;
};

}  // namespace uplink::front
