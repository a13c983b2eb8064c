#pragma once

#include <atomic>

#include "schema/base/clock.h"
#include "tests/support/manual_clock.h"

namespace uplink::testing {

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
