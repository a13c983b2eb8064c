#pragma once

#include <chrono>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::session {

/// For so long the bytes of an incomplete frame count as signs of life: a frame of 1 MB takes 20 s
/// over a link of 50 kB/s. A peer that drips bytes gains nothing, since its next frame begins where
/// this one ends.
inline constexpr std::chrono::seconds kSlowFrameMax{60};

/// The incomplete frame of a stream. A value; confined to the stream's thread.
class SlowFrame final {
 public:
  /// Bytes of it came. True if they count as a sign of life.
  [[nodiscard]] bool Add(SteadyTime now);
  /// The frame is complete.
  void End() { began_.reset(); }

 private:
  std::optional<SteadyTime> began_;
};

}  // namespace uplink::session
