#pragma once

#include <algorithm>
#include <cstddef>

#include "schema/base/clock.h"

namespace uplink::transport {

/// The time between two streams of one thread that a drain tells.
inline constexpr milliseconds kDrainSpacing{1};
/// Streams are told within at most 1 / kDrainPart of the grace.
inline constexpr int kDrainPart = 4;

/// When each stream of a thread is told that the server drains: one after the other, so that their
/// robots do not all come back at once. A value.
class DrainSpread final {
 public:
  DrainSpread(std::size_t streams, SteadyTime now, milliseconds grace)
      : streams_(static_cast<milliseconds::rep>(std::max<std::size_t>(streams, 1))),
        now_(now),
        spread_(std::min<SteadyTime::duration>(grace / kDrainPart, streams_ * kDrainSpacing)) {}

  [[nodiscard]] SteadyTime At(std::size_t index) const {
    return now_ + spread_ * static_cast<milliseconds::rep>(index) / streams_;
  }

 private:
  const milliseconds::rep streams_;
  const SteadyTime now_;
  const SteadyTime::duration spread_;
};

}  // namespace uplink::transport
