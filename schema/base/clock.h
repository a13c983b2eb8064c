#pragma once

#include <chrono>
#include <cstdint>

namespace uplink {

/// A point on the server's monotonic clock. Presence, timers and latencies use it.
using SteadyTime = std::chrono::steady_clock::time_point;

/// A point of civil time, UTC, in milliseconds: arrival stamps that people and rows see.
using SystemTime = std::chrono::sys_time<std::chrono::milliseconds>;

using std::chrono::milliseconds;

/// The only source of time in uplinkd; passed in, so that tests move time by hand.
///
/// Thread: implementations are thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual SteadyTime Steady() const = 0;
  [[nodiscard]] virtual SystemTime System() const = 0;
};

/// The machine's clocks. Thread-safe.
class SystemClock final : public Clock {
 public:
  [[nodiscard]] SteadyTime Steady() const override;
  [[nodiscard]] SystemTime System() const override;
};

/// Unix milliseconds of a civil time.
[[nodiscard]] constexpr std::int64_t UnixMs(SystemTime time) {
  return time.time_since_epoch().count();
}

/// The civil time of Unix milliseconds.
[[nodiscard]] constexpr SystemTime FromUnixMs(std::int64_t unix_ms) {
  return SystemTime(milliseconds(unix_ms));
}

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
