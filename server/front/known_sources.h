#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <mutex>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/front/source_address.h"

namespace uplink::front {

/// How long a source stays known after a robot streamed from it.
inline constexpr std::chrono::hours kKnownFor{1};
/// Past it the source that was noted least recently is forgotten. Each takes about 110 bytes.
inline constexpr std::size_t kKnownSourcesMax = 65'536;

/// The sources from which a robot streamed within the last hour: their connections come before a
/// stranger's. Each call is O(1) amortised. Thread-safe.
class KnownSources final {
 public:
  /// A robot streams from there now.
  void Note(const SourceAddress& source, SteadyTime now);
  [[nodiscard]] bool IsKnown(const SourceAddress& source, SteadyTime now) const;
  /// Sources in memory: those that are known no more go when the next one is noted.
  [[nodiscard]] std::size_t size() const;

 private:
  struct Entry {
    SourceAddress source;
    SteadyTime noted;
  };
  using Entries = std::list<Entry>;

  /// The one that was noted least recently.
  void ForgetLast();

  mutable std::mutex mutex_;
  /// From the one noted latest to the one noted least recently.
  Entries entries_;
  std::unordered_map<SourceAddress, Entries::iterator> by_source_;
};

}  // namespace uplink::front
