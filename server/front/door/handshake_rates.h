#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <map>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"

namespace uplink::front {

/// Handshakes per second of a source that wants no more than its part, and at once after a pause: a
/// site of 40 robots behind one address comes back without a wait.
inline constexpr int kHandshakesPerSecond = 20;
inline constexpr int kHandshakesAtOnce = 40;
/// Past it the source that was noted least recently is forgotten. Each takes about 150 bytes.
inline constexpr std::size_t kRatedSourcesMax = 8192;

/// Which sources began more handshakes lately than kHandshakesPerSecond and kHandshakesAtOnce. What
/// follows from it the caller decides. Each call is O(log kRatedSourcesMax).
///
/// Thread: confined to the acceptor's.
class HandshakeRates final {
 public:
  /// A handshake of the source begins.
  void Note(const SourceAddress& source, SteadyTime now);
  /// When the source is within the rate again; not after `now` if it is.
  [[nodiscard]] SteadyTime WithinAt(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory: those that have not used anything of late go when the next one is noted.
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    SourceAddress source;
    /// When it may have kHandshakesAtOnce again.
    SteadyTime idle_at;
  };
  using Entries = std::list<Entry>;

  void ForgetLast();

  /// From the one noted latest to the one noted least recently.
  Entries entries_;
  std::map<SourceAddress, Entries::iterator> by_source_;
};

}  // namespace uplink::front
