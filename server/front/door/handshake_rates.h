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
/// Past it the source that was noted least recently is forgotten. Each takes what
/// limits::RecentKeys does.
inline constexpr std::size_t kRatedSourcesMax =
    limits::PolicyOf(limits::PolicyId::kHandshakesOfSource).keys_max;

/// Which sources began more handshakes lately than kHandshakesPerSecond and kHandshakesAtOnce. What
/// follows from it the caller decides, so a source may go over: unlike a limits::TokenBucket this
/// remembers no more than one handshake of that. Each call is O(log kRatedSourcesMax).
///
/// Thread: confined to the acceptor's.
class HandshakeRates final {
 public:
  /// A handshake of the source begins.
  void Note(const SourceAddress& source, SteadyTime now);
  /// When the source is within the rate again; not after `now` if it is.
  [[nodiscard]] SteadyTime WithinAt(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory: those that have not used anything of late go when the next one is noted.
  [[nodiscard]] std::size_t size() const { return idle_at_.size(); }

 private:
  /// When each source may have kHandshakesAtOnce again.
  limits::RecentKeys<SourceAddress, SteadyTime, kRatedSourcesMax> idle_at_;
};

}  // namespace uplink::front
