#pragma once

#include "schema/base/clock.h"

namespace uplink {

/// A monotonic clock that goes on while the machine is suspended, where Clock::Steady stands still.
/// Only distances between two of its points mean anything.
///
/// Thread: implementations are thread-safe.
class BootClock {
 public:
  virtual ~BootClock() = default;
  [[nodiscard]] virtual SteadyTime Boot() const = 0;
};

/// The machine's. Thread-safe. Source: CLOCK_BOOTTIME in clock_gettime(2).
class SystemBootClock final : public BootClock {
 public:
  [[nodiscard]] SteadyTime Boot() const override;
};

}  // namespace uplink
