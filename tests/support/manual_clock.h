#pragma once

#include <atomic>
#include <mutex>

#include "schema/base/clock.h"

namespace uplink::testing {

/// A clock that stands still until it is moved. Thread-safe.
class ManualClock final : public Clock {
 public:
  /// Civil time starts at `start`; the monotonic clock at one hour, so that tests can look back.
  explicit ManualClock(SystemTime start = FromUnixMs(1'763'683'200'000)) : system_(start) {}

  [[nodiscard]] SteadyTime Steady() const override {
    const std::lock_guard lock(mutex_);
    return steady_;
  }
  [[nodiscard]] SystemTime System() const override {
    const std::lock_guard lock(mutex_);
    return system_;
  }

  /// Moves both clocks.
  void Advance(milliseconds by) {
    const std::lock_guard lock(mutex_);
    steady_ += by;
    system_ += by;
  }
  /// Moves civil time alone, as a clock correction does.
  void SetSystem(SystemTime time) {
    const std::lock_guard lock(mutex_);
    system_ = time;
  }

 private:
  mutable std::mutex mutex_;
  SteadyTime steady_{std::chrono::hours(1)};
  SystemTime system_;
};

/// The boot clock beside a clock that is moved by hand: it goes on with that, and while the machine
/// is suspended. Thread-safe.
class ManualBootClock final : public BootClock {
 public:
  /// `clock` outlives it.
  explicit ManualBootClock(const ManualClock& clock) : clock_(clock) {}

  [[nodiscard]] SteadyTime Boot() const override { return clock_.Steady() + suspended_.load(); }
  void Suspend(milliseconds by) { suspended_.store(suspended_.load() + by); }

 private:
  const ManualClock& clock_;
  std::atomic<milliseconds> suspended_{milliseconds(0)};
};

}  // namespace uplink::testing
