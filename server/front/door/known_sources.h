#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <mutex>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/front/door/source_address.h"

namespace uplink::front {

/// How long a source stays known after a robot's last stream from it ended.
inline constexpr std::chrono::hours kKnownFor{1};
/// Of those without a stream: past it the one whose stream ended least recently is forgotten. Each
/// takes about 110 bytes.
inline constexpr std::size_t kKnownSourcesMax = 65'536;

/// The sources from which a robot streams, or streamed within the last hour: their connections come
/// before a stranger's. Each call is O(1) amortised. Thread-safe.
///
/// Limits: kKnownSourcesMax, and as many sources as there are streams (transport::Gate).
class KnownSources final {
 public:
  /// A robot's stream from there began; Leave must follow.
  void Enter(const SourceAddress& source);
  /// It ended.
  void Leave(const SourceAddress& source, SteadyTime now);
  [[nodiscard]] bool IsKnown(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory from which a stream ended: those that are known no more go when the next one
  /// ends.
  [[nodiscard]] std::size_t size() const;

 private:
  struct Entry {
    SourceAddress source;
    SteadyTime noted;
  };
  using Entries = std::list<Entry>;

  /// A stream from there ended.
  void Note(const SourceAddress& source, SteadyTime now);
  /// The one that was noted least recently.
  void ForgetLast();

  mutable std::mutex mutex_;
  /// How many streams each source has that has any.
  std::unordered_map<SourceAddress, std::size_t> streams_;
  /// From the one noted latest to the one noted least recently.
  Entries entries_;
  std::unordered_map<SourceAddress, Entries::iterator> by_source_;
};

}  // namespace uplink::front
