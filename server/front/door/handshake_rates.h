#pragma once

#include <chrono>
#include <cstddef>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"
#include "server/limits/recent_keys.h"

namespace uplink::front {

/// Handshakes per second of a source that wants no more than its part, and at once after a pause: a
/// site of 40 robots behind one address comes back without a wait.
inline constexpr int kHandshakesPerSecond = 20;
inline constexpr int kHandshakesAtOnce = 40;
/// Past it the source that was noted least recently is forgotten. Each takes what
/// limits::RecentKeys does.
inline constexpr std::size_t kRatedSourcesMax = 8192;

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
