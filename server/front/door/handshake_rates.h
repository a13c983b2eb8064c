#pragma once

#include <chrono>
#include <cstddef>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"
#include "server/limits/policies.h"
#include "server/limits/recent_keys.h"

namespace uplink::front {

/// Handshakes per second of a source, and at once after a pause.
inline constexpr int kHandshakesPerSecond =
    limits::PolicyOf(limits::PolicyId::kHandshakesOfSource).most;
inline constexpr int kHandshakesAtOnce =
    limits::PolicyOf(limits::PolicyId::kHandshakesOfSource).at_once;
/// Past it the source that was noted least recently is forgotten. Each takes the memory of a
/// limits::RecentKeys entry.
inline constexpr std::size_t kRatedSourcesMax =
    limits::PolicyOf(limits::PolicyId::kHandshakesOfSource).keys_max;

/// Which sources recently began more handshakes than kHandshakesPerSecond and kHandshakesAtOnce.
/// The caller decides what follows, so a source may exceed the rate: unlike a limits::TokenBucket,
/// this remembers at most one handshake beyond it. Each call is O(log kRatedSourcesMax).
///
/// Thread: confined to the acceptor's.
class HandshakeRates final {
 public:
  /// A handshake of the source begins.
  void Note(const SourceAddress& source, SteadyTime now);
  /// When the source is within the rate again; not after `now` if it is.
  [[nodiscard]] SteadyTime WithinAt(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory; unused ones go when the next one is noted.
  [[nodiscard]] std::size_t size() const { return idle_at_.size(); }

 private:
  /// When each source may have kHandshakesAtOnce again.
  limits::RecentKeys<SourceAddress, SteadyTime, kRatedSourcesMax> idle_at_;
};

}  // namespace uplink::front
