#pragma once

#include <chrono>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::session {

/// So long from its first byte on do the bytes of a frame that is not whole count as signs of life:
/// a frame of 1 MB takes 20 s over a link of 50 kB/s. A peer that only drips bytes gains no more,
/// since its next frame begins where this one ends.
inline constexpr std::chrono::seconds kSlowFrameMax{60};

/// The frame that a stream is in the middle of. A value; confined to the stream's thread.
class SlowFrame final {
 public:
  /// Bytes of it came. True if they count.
  [[nodiscard]] bool Add(SteadyTime now);
  /// It is whole.
  void End() { began_.reset(); }

 private:
  std::optional<SteadyTime> began_;
};

}  // namespace uplink::session
