#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

#include "metrics/cells.h"
#include "schema/base/clock.h"

namespace uplink::fleet {

/// How often the handshake probe asks the relay's listener, once at a time, and how long it may
/// take.
inline constexpr std::chrono::seconds kHandshakeEvery{2};
inline constexpr std::chrono::seconds kHandshakeWait{20};
/// A handshake waits where the robots' messages wait: if it takes longer than this, they lie
/// unread.
inline constexpr std::chrono::seconds kBehindAfter{3};
/// A handshake that takes at most this long shows that messages are read in time again.
inline constexpr std::chrono::seconds kCaughtUpWithin{1};
static_assert(kCaughtUpWithin < kBehindAfter, "a relay that has caught up is not behind");
/// After so long without a sign of the listener, the process counts as dead.
inline constexpr std::chrono::seconds kAliveMax{60};
static_assert(kHandshakeEvery + kHandshakeWait < kAliveMax, "one lost answer must not kill");

/// Whether the relay listener still answers. The handshake probe shows that, and so does a stream
/// that opens, since a robot's handshake came before it. Counts from its construction. Thread-safe.
class Liveness final {
 public:
  /// `streams_total`: streams that were opened; it outlives this.
  Liveness(const Clock& clock, const metrics::Cell& streams_total);

  /// The listener is there from now on: its silence counts from here.
  void BeginListening();
  /// A probe begins. While none is answered, the wait counts from the first.
  void NoteAsked();
  /// The listener answered a ClientHello.
  void NoteHandshake();
  /// The process stood still until now. A probe under way began before, so its answer says nothing
  /// about messages that lie unread.
  void NoteStandstill();
  /// Time since the last sign.
  [[nodiscard]] milliseconds age() const;
  [[nodiscard]] bool alive() const { return age() <= kAliveMax; }
  /// Whether the relay is behind with reading, so that a robot's silence proves nothing: from
  /// kBehindAfter without an answer, or from a standstill, until a probe that began afterwards is
  /// answered within kCaughtUpWithin.
  [[nodiscard]] bool behind() const;
  /// How often the process stood still.
  [[nodiscard]] std::int64_t standstills() const;

 private:
  const Clock& clock_;
  const metrics::Cell& streams_total_;
  mutable std::mutex mutex_;
  mutable SteadyTime last_;
  mutable std::int64_t streams_seen_;
  /// The first handshake that has no answer yet, of those since the last standstill.
  std::optional<SteadyTime> asked_;
  /// The last answer was late, or we stood still, and no answer came in time since.
  bool late_ = false;
  std::int64_t standstills_ = 0;
};

}  // namespace uplink::fleet
