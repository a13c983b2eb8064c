#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::limits {

/// The last `kMax` times at which something happened. It lets exactly `kMax` through in any span at
/// most, where a TokenBucket does so on average. A value; confined to its owner.
template <std::size_t kMax>
class RecentTimes final {
 public:
  /// Records that it happens now, full or not.
  void Note(SteadyTime now) {
    times_[next_] = now;
    next_ = static_cast<std::uint32_t>((next_ + 1) % kMax);
    size_ = static_cast<std::uint32_t>(std::min<std::size_t>(size_ + 1, kMax));
  }
  /// Whether it happened `kMax` times within the last `span`.
  [[nodiscard]] bool IsFull(SteadyTime now, SteadyTime::duration span) const {
    return size_ == kMax && now - times_[next_] < span;
  }
  /// Notes it unless full. False: it may not happen now.
  [[nodiscard]] bool Take(SteadyTime now, SteadyTime::duration span) {
    if (IsFull(now, span)) return false;
    Note(now);
    return true;
  }
  /// How often it happened within the last `span`, `kMax` at most.
  [[nodiscard]] std::size_t Within(SteadyTime now, SteadyTime::duration span) const {
    return static_cast<std::size_t>(
        std::count_if(times_.begin(), times_.begin() + size_,
                      [&](SteadyTime time) { return now - time < span; }));
  }

 private:
  /// A ring: once full, the oldest is at next_.
  std::array<SteadyTime, kMax> times_{};
  std::uint32_t next_ = 0;
  std::uint32_t size_ = 0;
};

}  // namespace uplink::limits
