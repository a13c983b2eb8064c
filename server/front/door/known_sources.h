#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"
#include "server/limits/key_counts.h"
#include "server/limits/recent_keys.h"

namespace uplink::front {

/// How long a source stays known after a robot's last stream from it ended.
inline constexpr std::chrono::hours kKnownFor{1};
/// Sources without a stream; past it the one whose stream ended least recently is forgotten. Each
/// takes the memory of a limits::RecentKeys entry.
inline constexpr std::size_t kKnownSourcesMax = 65'536;

/// The sources from which a robot streams, or streamed within the last hour: their connections come
/// before a stranger's. Thread-safe.
///
/// Limits: kKnownSourcesMax, and as many sources as there are streams (transport::Gate).
class KnownSources final {
 public:
  /// A robot's stream from there began; Leave must follow.
  void Enter(const SourceAddress& source);
  /// It ended.
  void Leave(const SourceAddress& source, SteadyTime now);
  [[nodiscard]] bool IsKnown(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory from which a stream ended; those that are no longer known go when the next
  /// stream ends.
  [[nodiscard]] std::size_t size() const;

 private:
  mutable std::mutex mutex_;
  limits::KeyCounts<SourceAddress> streams_;
  /// When a stream from each source last ended.
  limits::RecentKeys<SourceAddress, SteadyTime, kKnownSourcesMax> ended_;
};

}  // namespace uplink::front
