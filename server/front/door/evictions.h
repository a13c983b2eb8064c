#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

#include "schema/base/clock.h"
#include "server/front/door/key_table.h"
#include "server/limits/recent_keys.h"
#include "server/limits/recent_times.h"

namespace uplink::front {

/// A key with so many evictions within kEvictionsWithin is flagged: more of its robots, or copies
/// of it, connect than it may have connections. The count stops there.
inline constexpr std::size_t kEvictionsFlagged = 10;
inline constexpr std::chrono::seconds kEvictionsWithin{60};

/// When keys last had more connections than allowed, whether or not they have one now.
///
/// Limits: kEvictionsFlagged times per key; kKeysMax keys, past which the key with the oldest last
///         eviction is forgotten.
/// Thread: thread-safe.
class Evictions final {
 public:
  static constexpr std::size_t kKeysMax = 1024;

  /// A connection of the key was evicted. Returns how many were within kEvictionsWithin, this one
  /// included, up to kEvictionsFlagged.
  std::size_t Note(const KeyDigest& digest, SteadyTime now) {
    const std::lock_guard lock(mutex_);
    auto& times = keys_.Touch(digest);
    times.Note(now);
    return times.Within(now, kEvictionsWithin);
  }

 private:
  std::mutex mutex_;
  limits::RecentKeys<KeyDigest, limits::RecentTimes<kEvictionsFlagged>, kKeysMax> keys_;
};

}  // namespace uplink::front
