#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>

#include "schema/base/clock.h"

namespace uplink::store {

/// A clock that is behind the store's mark by no more than this counts as right: servers that share
/// a mark differ a little.
inline constexpr std::chrono::minutes kBeforeMarkMax{1};

/// The machine's clocks, except that civil time is never well before the store's mark: rows stamped
/// by a clock that is behind would be too old, and be deleted, once the clock is right.
///
/// Thread: thread-safe. NoteMark by one thread.
class MarkedClock final : public Clock {
 public:
  /// `machine` outlives this.
  explicit MarkedClock(const Clock& machine) : machine_(machine) {}

  [[nodiscard]] SteadyTime Steady() const override { return machine_.Steady(); }
  /// The machine's time. If that is before the mark by more than kBeforeMarkMax, the mark's,
  /// advanced by the monotonic clock.
  [[nodiscard]] SystemTime System() const override;
  /// The store's mark as it was read at `at`; it may have gone back.
  void NoteMark(SystemTime mark, SteadyTime at);
  /// The kernel or the database confirms the machine's clock, or there is no mark.
  void ForgetMark() { mark_less_steady_ms_.store(kNone); }
  [[nodiscard]] const Clock& machine() const { return machine_; }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::min();
  static std::int64_t SteadyMs(SteadyTime time) {
    return std::chrono::duration_cast<milliseconds>(time.time_since_epoch()).count();
  }

  const Clock& machine_;
  std::atomic<std::int64_t> mark_less_steady_ms_{kNone};
};

}  // namespace uplink::store
