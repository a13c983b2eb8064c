#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>

#include "schema/base/clock.h"
#include "server/session/probe.h"

namespace uplink::health {

/// How often the background handshake asks the relay listener, and how long one may take.
inline constexpr std::chrono::seconds kHandshakeEvery{10};
inline constexpr std::chrono::seconds kHandshakeWait{5};
/// Without any sign of the listener for so long the process counts as dead.
inline constexpr std::chrono::seconds kAliveMax{60};
static_assert(kHandshakeEvery + kHandshakeWait < kAliveMax, "one lost answer must not kill");

/// Whether the relay listener still answers: the background handshake says so, and so does a stream
/// that opens, since a robot's handshake came before it. Counts from its making. Thread-safe.
class Liveness final {
 public:
  Liveness(const Clock& clock, const session::SessionProbe& sessions);

  /// The listener answered a ClientHello.
  void NoteHandshake();
  /// Time since the last sign.
  [[nodiscard]] milliseconds age() const;
  [[nodiscard]] bool alive() const { return age() <= kAliveMax; }

 private:
  const Clock& clock_;
  const session::SessionProbe& sessions_;
  mutable std::mutex mutex_;
  mutable SteadyTime last_;
  mutable std::int64_t streams_seen_;
};

}  // namespace uplink::health
