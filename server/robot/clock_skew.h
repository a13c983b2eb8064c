#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::robot {

/// The estimate looks back over one to two of these.
inline constexpr std::chrono::seconds kClockSkewWindow{60};
/// What an agent says beyond that is no time in milliseconds. A clock that starts in 1970, without
/// a battery, is within it.
inline constexpr std::chrono::milliseconds kClockSkewMax = std::chrono::hours(24 * 36'525);

/// Estimates an agent's clock less ours. Each batch arrives some time after its agent read its
/// clock, so the difference of each is too low by its delay. The highest of a window is that of the
/// least delayed batch, and the nearest to the truth.
///
/// A clock that jumps forward shows at once, one that is set back when the window has passed.
///
/// Limits: holds two samples, whatever the rate. Thread: confined to its owner's lock.
class ClockSkew final {
 public:
  /// A batch that says this time, which must be positive, arrived at `now`. Returns whether the
  /// estimate has changed.
  bool Add(std::int64_t sent_unix_ms, SystemTime now, SteadyTime steady_now);
  /// The next sample begins a window: the agent may have been started anew. The estimate stays
  /// until then.
  void BeginWindow();
  /// What was known before the server's start. No effect if a sample came since.
  void Restore(const std::optional<std::int64_t>& estimate_ms) {
    if (!estimate_ms_) estimate_ms_ = estimate_ms;
  }

  /// Milliseconds; empty: no agent said its time.
  [[nodiscard]] const std::optional<std::int64_t>& estimate_ms() const { return estimate_ms_; }

 private:
  std::optional<std::int64_t> estimate_ms_;
  SteadyTime window_began_;
  /// The highest sample of the window, and of the one before it.
  std::optional<std::int64_t> highest_ms_;
  std::optional<std::int64_t> highest_before_ms_;
};

}  // namespace uplink::robot
